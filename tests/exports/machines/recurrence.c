/* A motor that is polled every microsecond, after the words of David Austin's article (2004) and of the library's own
 * documentation: a step is due one wait after the last; from rest the wait is c0, and each next one follows from it.
 *
 * Prints the microseconds between any two steps of a move from rest. Arguments: steps, highest speed, acceleration. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

struct motor {
    float acceleration, shortest, first;
    float wait;         /* of the ramp [us]; 0 at rest */
    int32_t ramp_steps; /* since rest; below 0: as many before it, once it slows down */
    int32_t left;
};

/* What comes after a step, or at the beginning of a move. */
static uint32_t next_wait(struct motor *motor)
{
    float speed = motor->wait > 0.0f ? 1e6f / motor->wait : 0.0f;
    int32_t needed = (int32_t)(speed * speed / (2.0f * motor->acceleration));
    if (motor->left == 0) return 0;
    if (motor->ramp_steps > 0) {
        if (needed >= motor->left) motor->ramp_steps = -needed;
    } else if (motor->ramp_steps < 0 && needed < motor->left) {
        motor->ramp_steps = -motor->ramp_steps;
    }
    if (motor->ramp_steps == 0) {
        motor->wait = motor->first;
    } else {
        motor->wait -= 2.0f * motor->wait / (4.0f * (float)motor->ramp_steps + 1.0f);
        if (motor->wait < motor->shortest) motor->wait = motor->shortest;
    }
    motor->ramp_steps++;
    return (uint32_t)motor->wait;
}

int main(int count, char **words)
{
    if (count != 4) return 1;
    float speed = strtof(words[2], NULL), acceleration = strtof(words[3], NULL);
    struct motor motor = {acceleration, 1e6f / speed, 0.676f * sqrtf(2.0f / acceleration) * 1e6f, 0.0f, 0,
                          (int32_t)strtol(words[1], NULL, 10)};
    uint32_t now = 0, last = 0, due = next_wait(&motor), before = 0;
    int is_first = 1;
    while (due != 0) {
        now += due > 1000000 ? due - (now - last) : 1; /* polling for minutes is of no use */
        if (now - last < due) continue;
        if (!is_first) printf("%u\n", now - before);
        is_first = 0;
        before = last = now;
        motor.left--;
        due = next_wait(&motor);
    }
    return 0;
}
