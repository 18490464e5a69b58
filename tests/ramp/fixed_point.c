/* The steps of the fixed-point ramps in portable C99: integers without sign, additions, multiplications and shifts.
 * x = mantissa / 2^32 / 16^exponent; fixed_point.py says what it means and where the constants come from.
 *
 * usage: fixed_point < ramps > states. A ramp is one line: taylor|newton, 1 upwards or 0 downwards, mantissa and
 * exponent to begin with, steps, c or the ramp index to begin with, mantissa and exponent of p1, of pS, and the four
 * multipliers. Each step writes its mantissa, exponent and interval as three numbers of 32 bits. */
#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>

#define LEAST_MANTISSA ((uint64_t)15 << 24)
#define MANTISSA_LIMIT ((uint64_t)240 << 24)

struct scaled {
    uint64_t mantissa; /* 32 bits once normalised and clamped */
    unsigned exponent;
};

static struct scaled normal(struct scaled x)
{
    if (x.mantissa < LEAST_MANTISSA) {
        x.mantissa <<= 4;
        x.exponent++;
    } else if (x.mantissa >= MANTISSA_LIMIT && x.exponent > 0) {
        x.mantissa >>= 4;
        x.exponent--;
    }
    return x;
}

static int shorter(struct scaled x, struct scaled other)
{
    return x.exponent > other.exponent || (x.exponent == other.exponent && x.mantissa < other.mantissa);
}

/* By how much x (1 + q + c q^2), q = x^2, is less (up) or more (down) than x. */
static uint64_t taylor_change(struct scaled from, uint32_t c, int up)
{
    const uint32_t high = (uint32_t)from.mantissa >> 16, low = (uint32_t)from.mantissa >> 8 & 255;
    const uint32_t q = (high * high + 128) >> 8;
    const uint32_t x = (high << 8) + 3 * (low | 1);
    const uint32_t square = (q >> 8) * ((q >> 8) + 1);
    const unsigned shift = 8 + 8 * from.exponent;
    const uint64_t half = (uint64_t)1 << (shift - 1);
    const uint64_t cq2 =
        (uint64_t)(c >> 16) * square + (c >> 8 & 255) * (square >> 8) + (c & 255) * (square >> 16);
    const uint64_t second = (cq2 + half) >> shift;
    uint64_t factor, product;
    if (up)
        factor = q > second ? q - second : 0;
    else
        factor = q + second < 0xFFFFFF ? q + second : 0xFFFFFF;
    product = (x >> 8) * factor + (x & 255) * (factor >> 8);
    return (product + half) >> shift;
}

static struct scaled taylor(struct scaled x, uint32_t c, int up, struct scaled longest, struct scaled shortest)
{
    const uint64_t change = taylor_change(x, c, up);
    x.mantissa = up ? x.mantissa - change : x.mantissa + change;
    x = normal(x);
    if (shorter(x, shortest)) x = shortest;
    return shorter(longest, x) ? longest : x;
}

/* One Newton step for 2 k x^2 = 1: x + x (1/2 - k x^2), k with 24 bits of fraction. */
static struct scaled newton(struct scaled from, uint64_t k)
{
    const uint32_t x = (uint32_t)((from.mantissa + 0x8000) >> 16), square = x * x;
    const uint32_t scaled = (uint32_t)(k >> (8 * from.exponent));
    const uint64_t product = (uint64_t)(scaled >> 24) * square + (uint64_t)(scaled >> 16 & 255) * (square >> 8) +
                             (scaled >> 8 & 255) * (square >> 16) + (scaled & 255) * (square >> 24);
    const uint64_t half = (uint64_t)1 << 31;
    if (product < half)
        from.mantissa = ((uint64_t)x << 16) + (x * ((half - product) >> 8) >> 8);
    else
        from.mantissa = ((uint64_t)x << 16) - (x * ((product - half) >> 8) >> 8);
    return normal(from);
}

static uint32_t interval(struct scaled x, uint32_t multiplier)
{
    const uint32_t mantissa = (uint32_t)x.mantissa, rounded = (multiplier + 0x8000) >> 16;
    return (uint32_t)((uint64_t)(mantissa >> 16) * multiplier >> 8) + (mantissa >> 8 & 255) * rounded;
}

static void write_state(struct scaled x, const uint32_t multipliers[4])
{
    const uint32_t out[3] = {(uint32_t)x.mantissa, x.exponent, interval(x, multipliers[x.exponent])};
    fwrite(out, sizeof out, 1, stdout);
}

int main(void)
{
    char method[8];
    int up;
    struct scaled x, longest, shortest;
    uint32_t steps, multipliers[4];
    uint64_t c_or_k;
    while (scanf("%7s %d %" SCNu64 " %u %" SCNu32 " %" SCNu64 " %" SCNu64 " %u %" SCNu64 " %u %" SCNu32 " %" SCNu32
                 " %" SCNu32 " %" SCNu32,
                 method, &up, &x.mantissa, &x.exponent, &steps, &c_or_k, &longest.mantissa, &longest.exponent,
                 &shortest.mantissa, &shortest.exponent, &multipliers[0], &multipliers[1], &multipliers[2],
                 &multipliers[3]) == 14) {
        for (uint32_t i = 0; i < steps; i++) {
            if (method[0] == 't') {
                x = taylor(x, (uint32_t)c_or_k, up, longest, shortest);
            } else {
                c_or_k += up ? (uint64_t)1 << 24 : -((uint64_t)1 << 24);
                x = newton(x, c_or_k);
            }
            write_state(x, multipliers);
        }
    }
    return ferror(stdout) ? 1 : 0;
}
