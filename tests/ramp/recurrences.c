/* The step-by-step methods as a C program computes them in float, up and then down, each in order of time.
 * usage: recurrences METHOD F v0 v a STEPS; prints one hexadecimal float bit pattern a line. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void print(float p)
{
    uint32_t bits;
    memcpy(&bits, &p, sizeof bits);
    printf("%08x\n", (unsigned)bits);
}

static float next(const char *method, float p, float m)
{
    const float q = m * p * p;
    if (!strcmp(method, "first_order")) return p * (1 + m * p * p);      /* (20) */
    if (!strcmp(method, "second_order")) return p * (1.0f + q + 1.5f * q * q); /* (22) */
    return p * (1 + q + q * q);                                          /* (23) */
}

static float clamped(float p, float shortest, float longest)
{
    return p < shortest ? shortest : p > longest ? longest : p;
}

int main(int count, char **words)
{
    if (count != 7) return 2;
    const char *method = words[1];
    const double F = atof(words[2]), v0 = atof(words[3]), v = atof(words[4]), a = atof(words[5]);
    const long steps = atol(words[6]);
    const float p1 = (float)(F / sqrt(v0 * v0 + 2 * a)), pS = (float)(F / v), R = (float)(a / (F * F));
    const float k = (float)(1 / (F * F)), gain = (float)(2 * a);
    const int newton = !strcmp(method, "newton");

    float p = p1, w = (float)(v0 * v0 + 2 * a);
    for (long i = 0; i < steps; i++) {
        if (i && newton) {
            w += gain;
            p = p + p * (1 - w * k * p * p) * 0.5f;
        } else if (i) {
            p = clamped(next(method, p, -R), pS, p1);
        }
        print(p);
    }
    p = pS;
    w = (float)(v0 * v0 + 2 * a * (steps + 1));
    for (long i = 0; i < steps; i++) {
        if (newton) {
            w -= gain;
            p = p + p * (1 - w * k * p * p) * 0.5f;
        } else {
            p = clamped(next(method, p, R), pS, p1);
        }
        print(p);
    }
    return 0;
}
