/* x + x (1/2 - k x^2); k = v^2 / 2 a, the steps from rest to here, grows or shrinks by 1 a step. */
static inline void ${name}_recur(struct ${name}_way *way)
{
    const uint64_t one = (uint64_t)1 << 24, half = (uint64_t)1 << 31;
    const uint32_t x = (uint32_t)(((uint64_t)way->x.mantissa + 0x8000) >> 16), square = x * x;
    uint32_t scaled;
    uint64_t product, mantissa;
    way->k = way->side->is_up ? way->k + one : way->k - one;
    scaled = (uint32_t)(way->k >> (8 * way->x.exponent));
    product = (uint64_t)(scaled >> 24) * square + (uint64_t)(scaled >> 16 & 255u) * (square >> 8) +
              (uint64_t)(scaled >> 8 & 255u) * (square >> 16) + (scaled & 255u) * (square >> 24);
    mantissa = (uint64_t)x << 16;
    if (product < half)
        mantissa += x * ((half - product) >> 8) >> 8;
    else
        mantissa -= x * ((product - half) >> 8) >> 8;
    way->x = ${name}_normal(mantissa, way->x.exponent);
}
