#include "stepramp/motion/formula.h"

enum {
    METHOD_AT = 0,
    SLEW_AT = 1,
    CARRY_DOWN_AT = 5,
    CARRY_UP_AT = 10,
    UP_AT = 15,
    DOWN_AT = UP_AT + SIDE_BYTES
};
enum { COMPROMISE = 1, NEWTON = 2 };
enum { AT_REST, GOING_UP, SLEWING, GOING_DOWN };
enum { EXPONENT_AT = 4, EXPONENTS = 4 };
/* A position on the ramp has a fraction of 8 bits. */
enum { ONE = 256 };

#define LEAST_MANTISSA ((uint32_t)LEAST_MANTISSA_BYTE << 24)

/* Little-endian, on any machine; on an AVR this makes half the code of shifts. */
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__

union number {
    uint8_t bytes[4];
    uint32_t value;
};

static inline uint32_t read_u24(const uint8_t *bytes)
{
    union number number = {{bytes[0], bytes[1], bytes[2], 0}};
    return number.value;
}

static inline uint32_t read_u32(const uint8_t *bytes)
{
    union number number = {{bytes[0], bytes[1], bytes[2], bytes[3]}};
    return number.value;
}

#else

static inline uint32_t read_u24(const uint8_t *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16;
}

static inline uint32_t read_u32(const uint8_t *bytes)
{
    return read_u24(bytes) | (uint32_t)bytes[3] << 24;
}

#endif

/* In assembly in avr/, which an Arduino build leaves out. */
#if !defined(__AVR_HAVE_MUL__) || defined(ARDUINO)

/* The interval of x in whole ticks: to the nearest, halves up. */
static uint32_t whole_ticks(struct formula_x x, const uint8_t *side)
{
    const uint8_t *output = side + SIDE_OUTPUTS_AT + 4 * x.exponent;
    uint32_t high = x.mantissa >> 16, rounded = (read_u24(output) + 0x8000u) >> 16;
    /* high * multiplier / 256 in 32 bits */
    uint32_t interval = high * (output[1] | (uint32_t)output[2] << 8) + (high * output[0] >> 8);
    interval += (x.mantissa >> 8 & 255) * rounded;
    uint8_t bits = (uint8_t)(8 * (output[3] & 3));
    return bits == 0 ? interval : (interval >> bits) + (interval >> (bits - 1) & 1);
}

/* At exponent 0 x may go beyond the longest one: up to the largest mantissa. */
static struct formula_x normal(uint64_t mantissa, int8_t exponent)
{
    if (mantissa < LEAST_MANTISSA) {
        mantissa <<= 4;
        exponent = (exponent + 1) & (EXPONENTS - 1);
    } else if (mantissa >= (uint32_t)MANTISSA_LIMIT_BYTE << 24 && exponent > 0) {
        mantissa >>= 4;
        exponent--;
    }
    return (struct formula_x){mantissa > UINT32_MAX ? UINT32_MAX : (uint32_t)mantissa, exponent};
}

/* By how much x (1 + q + c q^2), q = x^2, is less (up) or more (down) than x. */
static uint64_t taylor_change(struct formula_x x, uint8_t flags)
{
    uint32_t high = x.mantissa >> 16, low = x.mantissa >> 8 & 255;
    uint32_t q = (high * high + 128) >> 8;
    uint32_t upper = (high << 8) + 3 * (low | 1);
    uint8_t shift = (uint8_t)(8 + 8 * x.exponent);
    uint64_t half = (uint64_t)1 << (shift - 1);
    uint32_t factor = q;
    if ((flags & STEP_COMPROMISE) != 0) {
        uint64_t square = (uint64_t)(q >> 8) * ((q >> 8) + 1);
        uint32_t second = (uint32_t)((square + half) >> shift);
        factor = (flags & STEP_DOWN) != 0 ? q + second : q - second;
    }
    uint64_t product = (uint64_t)(upper >> 8) * factor + (upper & 255) * (factor >> 8);
    return (product + half) >> shift;
}

static struct formula_x taylor(struct formula_x x, uint8_t flags)
{
    uint64_t change = taylor_change(x, flags);
    return normal((flags & STEP_DOWN) != 0 ? x.mantissa + change : x.mantissa - change, x.exponent);
}

/* One Newton step for 2 k x^2 = 1: x + x (1/2 - k x^2), k with 24 bits of fraction. */
static struct formula_x newton(struct formula_x from, uint64_t k)
{
    uint32_t x = (uint32_t)(((uint64_t)from.mantissa + 0x8000u) >> 16), square = x * x;
    uint32_t scaled = (uint32_t)(k >> (8 * from.exponent));
    uint64_t product = (uint64_t)(scaled >> 24) * square + (uint64_t)(scaled >> 16 & 255) * (square >> 8) +
                       (scaled >> 8 & 255) * (square >> 16) + (scaled & 255) * (square >> 24);
    const uint64_t half = (uint64_t)1 << 31;
    uint64_t mantissa = (uint64_t)x << 16;
    if (product < half) {
        mantissa += x * ((half - product) >> 8) >> 8;
    } else {
        mantissa -= x * ((product - half) >> 8) >> 8;
    }
    return normal(mantissa, from.exponent);
}

void formula_step(struct formula_x *x, const uint8_t *side, uint32_t *intervals, uint8_t count, uint8_t flags,
                  uint32_t index)
{
    for (uint8_t i = 0; i < count; i++) {
        index = (flags & STEP_DOWN) != 0 ? index - 1 : index + 1;
        if ((flags & STEP_NEWTON) != 0) {
            *x = newton(*x, (uint64_t)index << 24 | read_u24(side + SIDE_INDEX_AT));
        } else {
            *x = taylor(*x, flags);
        }
        intervals[i] = whole_ticks(*x, side);
    }
}

void formula_multiply(struct formula_x *x, const uint8_t *ratio)
{
    uint64_t product = (uint64_t)x->mantissa * read_u32(ratio);
    x->exponent = (int8_t)(x->exponent - (int8_t)ratio[EXPONENT_AT]);
    if (product >> 32 < LEAST_MANTISSA) {
        product <<= 4;
        x->exponent++;
    }
    x->mantissa = (uint32_t)(product >> 32);
}

#endif

/* ---- from one side to the other ---- */

static struct formula_x read_x(const uint8_t *bytes)
{
    return (struct formula_x){read_u32(bytes), (int8_t)bytes[EXPONENT_AT]};
}

static bool is_longer(const struct formula_x *x, const struct formula_x *other)
{
    return x->exponent != other->exponent ? x->exponent < other->exponent : x->mantissa > other->mantissa;
}

/* x, or the end of a side that it is beyond. */
static void clamp(struct formula_x *x, const uint8_t *side)
{
    struct formula_x longest = read_x(side + SIDE_LONGEST_AT), shortest = read_x(side + SIDE_SHORTEST_AT);
    if (is_longer(x, &longest)) {
        *x = longest;
    }
    if (is_longer(&shortest, x)) {
        *x = shortest;
    }
}

/* The accelerations are different. */
static bool is_ratio(const uint8_t *ratio)
{
    return ratio[3] != 0;
}

/* x from one side's scale into that of the other. */
static void carry(struct formula_x *x, const uint8_t *from, const uint8_t *ratio, const uint8_t *to)
{
    clamp(x, from);
    if (is_ratio(ratio)) {
        formula_multiply(x, ratio);
    }
    clamp(x, to);
}

static uint32_t top_of(const uint8_t *side)
{
    return read_u24(side + SIDE_STEPS_AT) << 8;
}

/* A position, above 0, times the square of a ratio, rounded to the nearest; UINT32_MAX when it is that or more. */
static uint32_t times_square(uint32_t ramp_position, const uint8_t *root)
{
    struct formula_x x = {ramp_position, 0};
    for (; x.mantissa < LEAST_MANTISSA; x.mantissa <<= 4) {
        x.exponent++;
    }
    formula_multiply(&x, root);
    formula_multiply(&x, root);
    if (x.exponent < 0) {
        return UINT32_MAX;
    }
    bool half = false;
    for (; x.exponent > 0; x.exponent--) {
        half = (x.mantissa & 8) != 0;
        x.mantissa >>= 4;
    }
    return x.mantissa + half;
}

/* A position on one side as one on the other, from 1 step to its top. The root of the ratio is the one that carries x the
 * other way round. */
static uint32_t convert(uint32_t ramp_position, const uint8_t *root, const uint8_t *to)
{
    uint32_t top = top_of(to);
    if (is_ratio(root)) {
        ramp_position = times_square(ramp_position, root);
    }
    if (ramp_position < ONE) {
        ramp_position = ONE;
    }
    return ramp_position > top ? top : ramp_position;
}

static uint32_t rounded_up(uint32_t ramp_position)
{
    return (ramp_position + (ONE - 1)) >> 8;
}

/* Whole steps up to slew speed. */
static uint32_t room_above(const uint8_t *constants, uint32_t ramp_position)
{
    return read_u24(constants + UP_AT + SIDE_STEPS_AT) - ((ramp_position + ONE / 2) >> 8);
}

/* From a position on the ramp up. */
static uint32_t steps_down_from(const uint8_t *constants, uint32_t ramp_position)
{
    const uint8_t *down = constants + DOWN_AT;
    return room_above(constants, ramp_position) == 0 ? read_u24(down + SIDE_STEPS_AT)
                                                     : rounded_up(convert(ramp_position, constants + CARRY_UP_AT, down));
}

/* ---- along a side ---- */

/* The next intervals, `count` of them: within those of slew speed and p1. */
static void step(struct formula_state *state, const uint8_t *constants, uint32_t *intervals, uint8_t count,
                 uint32_t index)
{
    const uint8_t *side = constants + UP_AT;
    uint8_t flags = (uint8_t)(constants[METHOD_AT] << 1);
    if (state->phase == GOING_DOWN) {
        side = constants + DOWN_AT;
        flags |= STEP_DOWN;
    }
    if (count == 0) {
        return;
    }
    formula_step(&state->x, side, intervals, count, flags, index + read_u24(side + SIDE_INDEX_AT + 3));
    uint32_t shortest = formula_slew_interval(constants), longest = read_u32(side + SIDE_LONGEST_INTERVAL_AT), interval;
    do {
        interval = *intervals;
        if (interval < shortest) {
            interval = shortest;
        }
        if (interval > longest) {
            interval = longest;
        }
        *intervals++ = interval;
    } while (--count != 0);
    state->interval = interval;
}

/* The first interval of a ramp up, from rest or from within a ramp down. */
static void begin_up(struct formula_state *state, const uint8_t *constants)
{
    const uint8_t *side = constants + UP_AT;
    if (state->phase == AT_REST) {
        state->x = read_x(side + SIDE_LONGEST_AT);
        state->interval = read_u32(side + SIDE_LONGEST_INTERVAL_AT);
    } else {
        carry(&state->x, constants + DOWN_AT, constants + CARRY_UP_AT, side);
    }
    state->phase = GOING_UP;
}

uint8_t formula_up(struct formula_state *state, const uint8_t *constants, uint32_t *intervals, uint8_t most,
                   uint32_t axis_steps_left)
{
    uint32_t begin = state->ramp_position, end, steps_down;
    if (state->phase == GOING_DOWN) {
        /* the first step takes back the last one down */
        begin = convert(begin + ONE, constants + CARRY_DOWN_AT, constants + UP_AT) - ONE;
    }
    uint32_t room = room_above(constants, begin);
    uint8_t count = most < room ? most : (uint8_t)room, given = 0;
    for (;; count--) {
        if (count == 0) {
            return 0;
        }
        end = begin + (uint16_t)count * ONE;
        steps_down = steps_down_from(constants, end);
        if (count + steps_down <= axis_steps_left) {
            break;
        }
    }
    if (state->phase != GOING_UP) {
        begin_up(state, constants);
        intervals[given++] = state->interval;
    }
    step(state, constants, intervals + given, (uint8_t)(count - given), (begin >> 8) + given - 1);
    state->ramp_position = end;
    state->steps_down = steps_down;
    if (count == room) {
        state->phase = SLEWING;
        state->interval = formula_slew_interval(constants);
        state->ramp_position = top_of(constants + UP_AT);
    }
    return count;
}

uint8_t formula_down(struct formula_state *state, const uint8_t *constants, uint32_t *intervals, uint8_t most)
{
    const uint8_t *side = constants + DOWN_AT;
    uint8_t given = 0;
    if (most == 0 || state->phase == AT_REST) {
        return 0;
    }
    if (state->phase == SLEWING) {
        state->x = read_x(side + SIDE_SHORTEST_AT);
        state->ramp_position = top_of(side);
    } else if (state->phase == GOING_UP) {
        state->ramp_position = convert(state->ramp_position, constants + CARRY_UP_AT, side) - ONE;
        carry(&state->x, constants + UP_AT, constants + CARRY_DOWN_AT, side);
        intervals[given++] = state->interval;
        state->steps_down--;
    }
    state->phase = GOING_DOWN;
    uint8_t count = (uint8_t)(most - given);
    if (count > state->steps_down) {
        count = (uint8_t)state->steps_down;
    }
    step(state, constants, intervals + given, count, state->steps_down);
    state->steps_down -= count;
    state->ramp_position -= (uint16_t)count * ONE;
    if (state->steps_down == 0) {
        formula_rest(state);
    }
    return (uint8_t)(given + count);
}

void formula_rest(struct formula_state *state)
{
    state->phase = AT_REST;
    state->ramp_position = 0;
    state->steps_down = 0;
}

bool formula_slews(const struct formula_state *state)
{
    return state->phase == SLEWING;
}

uint32_t formula_slew_interval(const uint8_t *constants)
{
    return read_u32(constants + SLEW_AT);
}

uint32_t formula_hold_interval(const struct formula_state *state)
{
    return state->interval;
}

uint32_t formula_creep_interval(const uint8_t *constants)
{
    uint32_t up = read_u32(constants + UP_AT + SIDE_LONGEST_INTERVAL_AT);
    uint32_t down = read_u32(constants + DOWN_AT + SIDE_LONGEST_INTERVAL_AT);
    return up > down ? up : down;
}

/* ---- whether constants are good ---- */

static bool x_is_good(const uint8_t *x)
{
    return x[3] >= LEAST_MANTISSA_BYTE && x[3] < MANTISSA_LIMIT_BYTE && x[EXPONENT_AT] < EXPONENTS;
}

static bool side_is_good(const uint8_t *side, uint32_t shortest_allowed, uint32_t longest_allowed)
{
    uint32_t longest = read_u32(side + SIDE_LONGEST_INTERVAL_AT);
    return read_u24(side + SIDE_STEPS_AT) != 0 && longest >= shortest_allowed && longest <= longest_allowed &&
           x_is_good(side + SIDE_LONGEST_AT) && x_is_good(side + SIDE_SHORTEST_AT);
}

bool formula_check(const uint8_t *constants, uint8_t length, uint32_t shortest_allowed, uint32_t longest_allowed)
{
    if (length != FORMULA_BYTES) {
        return false;
    }
    uint32_t slew = formula_slew_interval(constants);
    return constants[METHOD_AT] <= NEWTON && slew >= shortest_allowed &&
           slew <= longest_allowed && side_is_good(constants + UP_AT, shortest_allowed, longest_allowed) &&
           side_is_good(constants + DOWN_AT, shortest_allowed, longest_allowed);
}
