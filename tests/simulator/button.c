/* Buttons between a pin and ground. */
#include <stdio.h>
#include <stdlib.h>

#include <simavr/sim_cycle_timers.h>

#include "host.h"

enum { MOST_PRESSES = 256 };

static struct press {
    unsigned pin;
    avr_cycle_count_t begin, end;
} presses[MOST_PRESSES];
static unsigned count;

static avr_cycle_count_t on_release(avr_t *avr, avr_cycle_count_t when, void *one)
{
    (void)when;
    ground_pin(avr, ((struct press *)one)->pin, false);
    return 0;
}

static avr_cycle_count_t on_press(avr_t *avr, avr_cycle_count_t when, void *one)
{
    struct press *press = one;
    ground_pin(avr, press->pin, true);
    avr_cycle_timer_register(avr, press->end - when, on_release, press);
    return 0;
}

static bool add(avr_t *avr, const char *text)
{
    struct press *press = &presses[count];
    double from_ms, to_ms;
    if (count == MOST_PRESSES || sscanf(text, "%u:%lf-%lf", &press->pin, &from_ms, &to_ms) != 3 || !ground_has_pin(press->pin) ||
        to_ms <= from_ms) {
        return false;
    }
    press->begin = (avr_cycle_count_t)(from_ms * (double)(CLOCK_HZ / 1000)) + 1;
    press->end = (avr_cycle_count_t)(to_ms * (double)(CLOCK_HZ / 1000)) + 1;
    ground_pin(avr, press->pin, false);
    avr_cycle_timer_register(avr, press->begin, on_press, press);
    count++;
    return true;
}

bool button_attach(avr_t *avr, const char *press)
{
    for (const char *one = press; one != NULL && *one != 0;) {
        char *end;
        if (!add(avr, one)) {
            return false;
        }
        for (end = (char *)one; *end != 0 && *end != ','; end++) {
        }
        one = *end == 0 ? end : end + 1;
    }
    return true;
}
