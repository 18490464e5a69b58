/* One side of the ramp. */
struct ${name}_side {
    uint32_t steps;
    uint32_t given;              /* how many intervals the first one stands for before the formula begins */
    ${name}_number first;        /* p1 (17) upwards, pS (18) downwards */
    ${name}_number multiplier;   /* m: -R upwards, R downwards (19) */
    ${name}_number shortest;     /* pS */
    ${name}_number longest;      /* p1 */
};
static const struct ${name}_side ${name}_up = {$up_steps, 1, $up_first, $up_multiplier, $slew, $up_longest};
static const struct ${name}_side ${name}_down = {$down_steps, 0, $slew, $down_multiplier, $slew, $down_longest};

/* Where on a side one is. */
struct ${name}_way {
    const struct ${name}_side *side;
    uint32_t given;
    ${name}_number interval;
};

static inline struct ${name}_way ${name}_start(const struct ${name}_side *side)
{
    const struct ${name}_way way = {side, side->given, side->first};
    return way;
}

/* The next interval of a side, in order of time. */
static inline ${name}_number ${name}_step(struct ${name}_way *way)
{
    const struct ${name}_side *const side = way->side;
    const ${name}_number p = way->interval, q = side->multiplier * p * p;
    if (way->given != 0) {
        way->given--;
        return p;
    }
    way->interval = p * ($series);
    if (way->interval < side->shortest) way->interval = side->shortest;
    if (way->interval > side->longest) way->interval = side->longest;
    return way->interval;
}
