/* firmware/src/stepramp/motion/formula.c on requests of bytes. On this machine: a program that reads requests and writes replies, each
 * after its length in one byte. On the chip: what the simulator hands requests to (see simulator.c). */
#include <stdint.h>
#include <string.h>

#include "stepramp/motion/formula.h"

#ifdef __AVR__
#include <avr/io.h>
#define TIMED(call)  \
    do {             \
        GPIOR0 = 1;  \
        call;        \
        GPIOR0 = 0;  \
    } while (0)
#else
#include <stdio.h>
#include <stdlib.h>
#define TIMED(call) call
#endif

enum { MOST_AT_ONCE = 60 };

uint8_t request[160];
uint8_t reply[1 + 4 * MOST_AT_ONCE + 5];

static uint8_t constants[FORMULA_BYTES];
static struct formula_state state;
static uint32_t intervals[MOST_AT_ONCE];

static uint32_t number_at(const uint8_t *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static uint8_t *put(uint8_t *to, uint32_t number)
{
    for (uint8_t i = 0; i < 4; i++) {
        *to++ = (uint8_t)(number >> (8 * i));
    }
    return to;
}

static uint8_t *put_intervals(uint8_t *to, uint8_t count)
{
    for (uint8_t i = 0; i < count; i++) {
        to = put(to, intervals[i]);
    }
    return to;
}

/* Answers the request; returns the length of the reply. */
uint8_t answer(void)
{
    uint8_t *to = reply;
    const uint8_t *from = request + 1;
    uint8_t count = 0;
    struct formula_x x;
    switch (request[0]) {
    case 'c': /* check: shortest, longest, constants */
        memcpy(constants, from + 8, sizeof constants);
        TIMED(*to++ = formula_check(constants, sizeof constants, number_at(from), number_at(from + 4)));
        formula_rest(&state);
        break;
    case 'u': /* up: steps left, most */
        TIMED(count = formula_up(&state, constants, intervals, from[4], number_at(from)));
        to = put_intervals(to, count);
        break;
    case 'd': /* down: most */
        TIMED(count = formula_down(&state, constants, intervals, from[0]));
        to = put_intervals(to, count);
        break;
    case 's': /* state */
        to = put(to, formula_steps_down(&state));
        to = put(to, formula_hold_interval(&state));
        to = put(to, formula_creep_interval(constants));
        *to++ = formula_slews(&state);
        break;
    case 'k': /* steps: count, flags, index, mantissa, exponent, way */
        x = (struct formula_x){number_at(from + 6), (int8_t)from[10]};
        TIMED(formula_step(&x, from + 11, intervals, from[0], from[1], number_at(from + 2)));
        to = put(to, x.mantissa);
        *to++ = (uint8_t)x.exponent;
        to = put_intervals(to, from[0]);
        break;
    default:
        break;
    }
    return (uint8_t)(to - reply);
}

#ifdef __AVR__

volatile uint8_t length; /* of the reply, and 1 more; 0 while a request waits */

int main(void)
{
    length = 1;
    for (;;) {
        /* The request comes from nowhere. */
        __asm__ volatile("" ::: "memory");
        if (length == 0) {
            length = (uint8_t)(answer() + 1);
        }
    }
}

#else

int main(void)
{
    for (int size; (size = getchar()) != EOF;) {
        if (fread(request, 1, (size_t)size, stdin) != (size_t)size) {
            return EXIT_FAILURE;
        }
        uint8_t length = answer();
        putchar(length);
        fwrite(reply, 1, length, stdout);
        put(reply, 0);
        fwrite(reply, 1, 4, stdout);
        fflush(stdout);
    }
    return EXIT_SUCCESS;
}

#endif
