/* What the benchmark compares the numerics with: exact, formulas (20), (22), (23) and their errors in plain C.
 * usage: methods F v0 v a STEPS; prints the median time of a round [ms]. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define MOST_ROUNDS 100

static double now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * 1e3 + now.tv_nsec * 1e-6;
}

static double *array(long size)
{
    double *made = malloc(size * sizeof *made);
    if (!made) exit(1);
    return made;
}

static double *exact(double F, double v0, double a, long steps)
{
    double *p = array(steps);
    for (long i = 0; i < steps; i++) p[i] = F / sqrt(v0 * v0 + 2 * a * (i + 1));
    return p;
}

static double *taylor(double F, double v0, double v, double a, double c, long steps)
{
    double *out = array(steps), p1 = F / sqrt(v0 * v0 + 2 * a), pS = F / v, m = -a / (F * F), p = p1;
    out[0] = p;
    for (long i = 1; i < steps; i++) {
        double q = m * p * p;
        p = p * (1 + q + c * q * q);
        if (p < pS) p = pS;
        if (p > p1) p = p1;
        out[i] = p;
    }
    return out;
}

static double *errors(const double *p, const double *reference, long steps)
{
    double *out = array(steps);
    for (long i = 0; i < steps; i++) out[i] = p[i] / reference[i] - 1;
    return out;
}

static double round_ms(double F, double v0, double v, double a, long steps)
{
    static const double coefficients[] = {0, 1.5, 1};
    double *made[7], began = now_ms();
    made[0] = exact(F, v0, a, steps);
    for (int i = 0; i < 3; i++) {
        made[1 + 2 * i] = taylor(F, v0, v, a, coefficients[i], steps);
        made[2 + 2 * i] = errors(made[1 + 2 * i], made[0], steps);
    }
    double spent = now_ms() - began;
    for (int i = 0; i < 7; i++) free(made[i]);
    return spent;
}

static int by_size(const void *one, const void *other)
{
    double a = *(const double *)one, b = *(const double *)other;
    return (a > b) - (a < b);
}

int main(int count, char **words)
{
    if (count != 6) return 2;
    double spent[MOST_ROUNDS], began = now_ms();
    int rounds = 0;
    while (rounds < 3 || (now_ms() - began < 1000 && rounds < MOST_ROUNDS))
        spent[rounds++] = round_ms(atof(words[1]), atof(words[2]), atof(words[3]), atof(words[4]), atol(words[5]));
    qsort(spent, rounds, sizeof *spent, by_size);
    printf("%.6f\n", spent[rounds / 2]);
    return 0;
}
