static inline int ${name}_is_shorter(struct ${name}_x x, struct ${name}_x other)
{
    return x.exponent > other.exponent || (x.exponent == other.exponent && x.mantissa < other.mantissa);
}

/* x (1 + q + c q^2) with c in 2^-16, q being subtracted upwards; kept between pS and p1. */
static inline void ${name}_recur(struct ${name}_way *way)
{
    const struct ${name}_side *const side = way->side;
    const struct ${name}_x from = way->x;
    const uint32_t c = $coefficient, high = from.mantissa >> 16, low = from.mantissa >> 8 & 255u;
    const uint32_t q = (high * high + 128) >> 8, x = (high << 8) + 3 * (low | 1u);
    const uint32_t square = (q >> 8) * ((q >> 8) + 1);
    const unsigned shift = 8u + 8u * from.exponent;
    const uint64_t half = (uint64_t)1 << (shift - 1);
    const uint64_t cq2 =
        (uint64_t)(c >> 16) * square + (uint64_t)(c >> 8 & 255u) * (square >> 8) + (c & 255u) * (square >> 16);
    const uint64_t second = (cq2 + half) >> shift;
    uint64_t factor, change;
    if (side->is_up)
        factor = q > second ? q - second : 0;
    else
        factor = q + second < 0xFFFFFF ? q + second : 0xFFFFFF;
    change = ((x >> 8) * factor + (x & 255u) * (factor >> 8) + half) >> shift;
    way->x = ${name}_normal(side->is_up ? from.mantissa - change : from.mantissa + change, from.exponent);
    if (${name}_is_shorter(way->x, side->shortest)) way->x = side->shortest;
    if (${name}_is_shorter(side->longest, way->x)) way->x = side->longest;
}
