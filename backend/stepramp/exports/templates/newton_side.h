/* One side of the ramp. */
struct ${name}_side {
    uint32_t steps;
    uint32_t given;       /* how many intervals the first one stands for before the formula begins */
    ${name}_number first; /* p1 (17) upwards, pS (18) downwards */
    ${name}_number w;     /* the square of the speed at which that is [steps^2/s^2] */
    ${name}_number gain;  /* what a step adds to it: 2 a upwards, -2 d downwards */
};
static const struct ${name}_side ${name}_up = {$up_steps, 1, $up_first, $up_w, $up_gain};
static const struct ${name}_side ${name}_down = {$down_steps, 0, $slew, $down_w, $down_gain};
static const ${name}_number ${name}_k = $k; /* 1 / F^2 */

/* Where on a side one is. */
struct ${name}_way {
    const struct ${name}_side *side;
    uint32_t given;
    ${name}_number interval, w;
};

static inline struct ${name}_way ${name}_start(const struct ${name}_side *side)
{
    const struct ${name}_way way = {side, side->given, side->first, side->w};
    return way;
}

/* The next interval of a side, in order of time. */
static inline ${name}_number ${name}_step(struct ${name}_way *way)
{
    const ${name}_number p = way->interval;
    if (way->given != 0) {
        way->given--;
        return p;
    }
    way->w = way->w + way->side->gain;
    way->interval = p + p * (1 - way->w * ${name}_k * p * p) * $half;
    return way->interval;
}
