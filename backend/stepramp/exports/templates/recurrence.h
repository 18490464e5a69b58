/* $title
 *
 * $formula, in $arithmetic. Numbers in brackets are formulas of
 * Eiderman, "Real time stepper motor linear ramping just by addition and multiplication" (2004).
 * F $timer_hz Hz, v0 $base_speed, v $slew_speed steps/s, a $acceleration, d $deceleration steps/s^2.
 * Intervals in ticks of F, rounded: $rounding.
 *
 *     struct ${name}_move move;
 *     ${name}_begin(&move, 1000);                   at rest; the direction is up to you
 *     while ((ticks = ${name}_next(&move)) != 0)    one pulse, then wait so long; 0: the move is over
 *         pulse_and_wait(ticks);
 *
 * A move too short for full speed takes the slowest intervals of both sides. ${name}_begin() finds out which, by
 * running along the ramp about log2(steps) times, and computes what is skipped of the deceleration: call it at rest.
 * Bit for bit what StepRamp plans where each operation is rounded to its type and none is fused with another: with GCC
 * by -std=c99, or by -ffp-contract=off. */
#ifndef $guard
#define $guard

#include <float.h>
#include <stdint.h>
$checks
#define ${prefix}_TIMER_HZ $timer_hz

typedef $ticks_type ${name}_ticks; /* an interval in whole ticks */
typedef $number ${name}_number; /* an interval as it is computed */

$side
static inline ${name}_ticks ${name}_whole(${name}_number interval$sum_parameter)
{
$whole
}

/* The shortest of some intervals of a side in whole ticks, in order of time: skipped ones first. */
static inline ${name}_ticks
${name}_shortest(const struct ${name}_side *side, uint32_t skipped, uint32_t counted)
{
    struct ${name}_state state = ${name}_start(side);
    ${name}_ticks shortest = $ticks_max;$sum_variable
    for (uint32_t i = 0; i < skipped + counted; i++) {
        const ${name}_ticks interval = ${name}_whole(${name}_step(&state)$sum_argument);
        if (i >= skipped && interval < shortest) shortest = interval;
    }
    return shortest;
}

/* How many of the slowest `steps` intervals are of the acceleration: the longer of the two next ones is taken, that of
 * the acceleration when they are equal. */
static inline uint32_t ${name}_steps_up(uint32_t steps)
{
    const uint32_t up = ${name}_up.steps, down = ${name}_down.steps;
    uint32_t least = steps > down ? steps - down : 0, most = steps < up ? steps : up;
    if (steps >= up && steps - up >= down) return up;
    while (least < most) {
        const uint32_t middle = least + (most - least + 1) / 2, rest = steps - middle + 1;
        const ${name}_ticks next_up = ${name}_shortest(&${name}_up, 0, middle);
        if (next_up >= ${name}_shortest(&${name}_down, down - rest, rest))
            least = middle;
        else
            most = middle - 1;
    }
    return least;
}

struct ${name}_move {
    struct ${name}_state up, down;
    uint32_t steps_up, steps_slew, steps_down; /* still to come */$sum_field
};

static inline void ${name}_begin(struct ${name}_move *move, uint32_t steps)
{
    move->up = ${name}_start(&${name}_up);
    move->down = ${name}_start(&${name}_down);
    move->steps_up = ${name}_steps_up(steps);
    move->steps_down = steps - move->steps_up;
    if (move->steps_down > ${name}_down.steps) move->steps_down = ${name}_down.steps;
    move->steps_slew = steps - move->steps_up - move->steps_down;
    for (uint32_t i = move->steps_down; i < ${name}_down.steps; i++) ${name}_step(&move->down);$sum_begin
}

static inline ${name}_ticks ${name}_next(struct ${name}_move *move)
{
    ${name}_number interval = $slew;
    if (move->steps_up != 0) {
        move->steps_up--;
        interval = ${name}_step(&move->up);
    } else if (move->steps_slew != 0) {
        move->steps_slew--;
    } else if (move->steps_down != 0) {
        move->steps_down--;
        interval = ${name}_step(&move->down);
    } else {
        return 0;
    }
    return ${name}_whole(interval$sum_of_move);
}

#endif
