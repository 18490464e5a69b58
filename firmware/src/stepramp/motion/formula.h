/* Ramps that are computed while they are played, by formulas (20) and (23) of Eiderman, "Real time stepper motor linear
 * ramping just by addition and multiplication" (2004), or by Newton's method, in integers.
 *
 * x = p sqrt(R) = sqrt(a) / v is mantissa / 2^32 / 16^exponent. The arithmetic, and the motion along such a
 * ramp, are defined by the host program, bit for bit.
 *
 * The constants are little-endian bytes, as a ramp image has them:
 *
 *    0  u8   method: 0 formula (20), 1 formula (23), 2 Newton's
 *    1  u32  slew interval [ticks]
 *    5  u32  sqrt(d / a): mantissa / 2^32, at least 2^28, or 0 when the accelerations are the same
 *    9  i8   and its exponent, to base 16
 *   10  u32  sqrt(a / d), in the same way
 *   14  i8
 *   15       the ramp up
 *   54       the ramp down
 *   93       end
 *
 * of which a side is
 *
 *    0  u24  n_up or n_down [steps], at least 1
 *    3  u32  interval p1, the longest [ticks]
 *    7  u32  the longest x, that of p1 (17): mantissa
 *   11  u8   and its exponent, 0 to 3
 *   12  u32  the shortest x, that of pS (18), in the same way
 *   16  u8
 *   17       for each exponent from 0 to 3: u24 multiplier, u8 bytes of fraction; an interval is
 *            mantissa * multiplier / 2^24, in units of 1 / 256^bytes ticks
 *   33  u24  ramp index v^2 / 2 a of p1, fraction in 2^-24 [steps]
 *   36  u24  and its whole part
 *   39       end */
#ifndef STEPRAMP_FORMULA_H
#define STEPRAMP_FORMULA_H

#define FORMULA_BYTES 93

/* Offsets in the bytes of a side. */
#define SIDE_STEPS_AT 0
#define SIDE_LONGEST_INTERVAL_AT 3
#define SIDE_LONGEST_AT 7
#define SIDE_SHORTEST_AT 12
#define SIDE_OUTPUTS_AT 17
#define SIDE_INDEX_AT 33
#define SIDE_BYTES 39

/* Mantissas are from 15/256 to below 240/256 of 2^32: highest byte. */
#define LEAST_MANTISSA_BYTE 15
#define MANTISSA_LIMIT_BYTE 240

/* How x goes on: sum of flags. Without the last two it is by formula (20). */
#define STEP_DOWN 1
#define STEP_COMPROMISE 2
#define STEP_NEWTON 4

#ifndef __ASSEMBLER__

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* x; the offsets 0 and 4 are known to the assembly. */
struct formula_x {
    uint32_t mantissa;
    int8_t exponent;
};

/* A motor on such a ramp. */
struct formula_state {
    struct formula_x x;
    uint32_t ramp_position; /* [1/256 steps of the side it is on] from rest to here */
    uint32_t steps_down;    /* from here to rest */
    uint32_t interval;      /* [ticks] the last one */
    uint8_t phase;
};

/* Checks constants. With constants that have been found good all intervals are from `shortest_allowed` to
 * `longest_allowed` ticks, whatever else is in them. */
bool formula_check(const uint8_t *constants, uint8_t length, uint32_t shortest_allowed, uint32_t longest_allowed);

/* At rest. */
void formula_rest(struct formula_state *state);

/* The next intervals of the ramp up: `most` of them or fewer, so that enough of `axis_steps_left` are left for the ramp down
 * after them. Returns how many: 0 at slew speed, too, or when `most` is 0. From rest the first one is p1; from within a
 * ramp down it is the last interval once more. Where there are none and it is not at slew speed, what is left over is
 * played at formula_hold_interval, or from rest at formula_creep_interval. */
uint8_t formula_up(struct formula_state *state, const uint8_t *constants, uint32_t *intervals, uint8_t most,
                   uint32_t axis_steps_left);

/* The next intervals of the ramp down, `most` of them or fewer; returns how many, 0 at rest. From within a ramp up the
 * first one is the last interval once more. */
uint8_t formula_down(struct formula_state *state, const uint8_t *constants, uint32_t *intervals, uint8_t most);

/* Steps of the ramp down from here to rest. */
static inline uint32_t formula_steps_down(const struct formula_state *state)
{
    return state->steps_down;
}

/* The ramp up has come to its end. */
bool formula_slews(const struct formula_state *state);

/* [ticks] */
uint32_t formula_slew_interval(const uint8_t *constants);

/* The interval that keeps the present speed: any number of them may be played in between. */
uint32_t formula_hold_interval(const struct formula_state *state);

/* The interval of moves that are too short for one step up and its ramp down. */
uint32_t formula_creep_interval(const uint8_t *constants);

/* The hot part, in assembly on an AVR: the next `count` intervals, at least one, along a side. `index`, for Newton's
 * method, is the whole part of the last interval's ramp index. */
void formula_step(struct formula_x *x, const uint8_t *side, uint32_t *intervals, uint8_t count, uint8_t flags,
                  uint32_t index);

/* Also in assembly: x times a ratio, mantissa and exponent as in the constants, rounded down. */
void formula_multiply(struct formula_x *x, const uint8_t *ratio);

#ifdef __cplusplus
}
#endif

#endif

#endif
