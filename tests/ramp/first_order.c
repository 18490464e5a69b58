/* Formula 20 of Eiderman as a C program computes it in float: the intervals of a ramp up and down, as bits.
 * usage: first_order F v0 v a up_steps down_steps; prints one hexadecimal float bit pattern a line, up then down. */
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

int main(int count, char **words)
{
    if (count != 7) return 2;
    const double F = atof(words[1]), v0 = atof(words[2]), v = atof(words[3]), a = atof(words[4]);
    const long up = atol(words[5]), down = atol(words[6]);
    const float p1 = (float)(F / sqrt(v0 * v0 + 2 * a)), pS = (float)(F / v), R = (float)(a / (F * F));
    float m = -R, p = p1;
    for (long i = 0; i < up; i++) {
        if (i) p = p * (1 + m * p * p);
        if (p < pS) p = pS;
        if (p > p1) p = p1;
        print(p);
    }
    m = R;
    p = pS;
    for (long i = 0; i < down; i++) {
        p = p * (1 + m * p * p);
        if (p < pS) p = pS;
        if (p > p1) p = p1;
        print(p);
    }
    return 0;
}
