/* x = p sqrt(R), R of (19), is mantissa / 2^32 / 16^exponent: then q = x^2, and the formulas need no constants. An
 * interval is x times F / sqrt(a), which is not fed back. */
struct ${name}_x {
    uint32_t mantissa;
    uint8_t exponent;
};

/* What makes ticks of a mantissa: mantissa * multiplier / 2^24 has so many bits of fraction. */
struct ${name}_output {
    uint32_t multiplier;
    uint8_t fraction_bits;
};

/* One side of the ramp. */
struct ${name}_side {
    uint32_t steps;
    uint32_t given;        /* how many intervals the first one stands for before the formula begins */
    struct ${name}_x first; /* that of p1 (17) upwards, of pS (18) downwards */
$side_fields
    struct ${name}_output outputs[4]; /* one for each exponent */
};
static const struct ${name}_side ${name}_up = $up;
static const struct ${name}_side ${name}_down = $down;

/* Where on a side one is. */
struct ${name}_state {
    const struct ${name}_side *side;
    uint32_t given;
    struct ${name}_x x;$state_fields
};

static inline struct ${name}_state ${name}_start(const struct ${name}_side *side)
{
    const struct ${name}_state state = {side, side->given, side->first$state_values};
    return state;
}

/* x with its mantissa in range, where its exponent can be changed. */
static inline struct ${name}_x ${name}_normal(uint64_t mantissa, uint8_t exponent)
{
    struct ${name}_x x;
    if (mantissa < ((uint64_t)15 << 24)) {
        mantissa <<= 4;
        exponent++;
    } else if (mantissa >= ((uint64_t)240 << 24) && exponent > 0) {
        mantissa >>= 4;
        exponent--;
    }
    x.mantissa = mantissa < UINT32_MAX ? (uint32_t)mantissa : UINT32_MAX;
    x.exponent = exponent;
    return x;
}

$change
/* The next interval of a side, in order of time. */
static inline ${name}_number ${name}_step(struct ${name}_state *state)
{
    uint32_t rounded, interval;
    const struct ${name}_output *output;
    if (state->given != 0)
        state->given--;
    else
        ${name}_recur(state);
    output = &state->side->outputs[state->x.exponent];
    rounded = (output->multiplier + 0x8000u) >> 16;
    interval = (uint32_t)((uint64_t)(state->x.mantissa >> 16) * output->multiplier >> 8) +
               (state->x.mantissa >> 8 & 255u) * rounded;
$made
}
