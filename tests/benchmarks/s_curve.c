/* What the benchmark compares S-curves with: the intervals of a ramp of jerk phases alone, in plain C.
 * usage: s_curve F v j STEPS; from rest, half of the steps at +j and half at -j; prints the median time of a round [ms]. */
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

/* Newton's method for v t + sign j t^3 / 6 = place, from a start on the side from which it doesn't pass the root. */
static double root(double v, double j, double sign, double place, double t)
{
    for (double change = t; fabs(change) > 4.4e-16 * t;) {
        double square = j * t * t;
        change = (t * (v + sign * square / 6) - place) / (v + sign * square / 2);
        if (sign * change <= 0) break;
        t -= change;
    }
    return t;
}

static double round_ms(double F, double v, double j, long steps)
{
    double began = now_ms(), *p = malloc(steps * sizeof *p), onset = sqrt(v / j), length = v * onset;
    double middle = onset * onset * onset * j / 6, t = -1, left = -1;
    if (!p) exit(1);
    for (long i = 1; i <= steps; i++) {
        if (i < middle) {
            double speed = t > 0 ? j * t * t / 2 : 0;
            t = root(0, j, 1, i, t > 0 ? t + 2 / (speed + sqrt(speed * speed + 2 * j * t)) : cbrt(6 * i / j));
            p[i - 1] = F / (j * t * t / 2);
        } else {
            double start = (length - i) / v, earlier = left - 1 / (v - j * left * left / 2);
            left = root(v, j, -1, length - i, left > 0 && earlier > start ? earlier : start);
            p[i - 1] = F / (v - j * left * left / 2);
        }
    }
    double spent = now_ms() - began;
    volatile double last = p[steps - 1];
    (void)last;
    free(p);
    return spent;
}

static int by_size(const void *one, const void *other)
{
    double a = *(const double *)one, b = *(const double *)other;
    return (a > b) - (a < b);
}

int main(int count, char **words)
{
    if (count != 5) return 2;
    double spent[MOST_ROUNDS], began = now_ms();
    int rounds = 0;
    while (rounds < 3 || (now_ms() - began < 1000 && rounds < MOST_ROUNDS))
        spent[rounds++] = round_ms(atof(words[1]), atof(words[2]), atof(words[3]), atol(words[4]));
    qsort(spent, rounds, sizeof *spent, by_size);
    printf("%.6f\n", spent[rounds / 2]);
    return 0;
}
