/* A button between a pin and ground, pressed once. */
#include <stdio.h>

#include <simavr/avr_ioport.h>
#include <simavr/sim_cycle_timers.h>

#include "host.h"

enum { FIRST_PIN_OF_PORT_C = 14 };

static int bit;
static avr_cycle_count_t released_at;

/* What is outside holds the pin down; otherwise its own pull-up has it. */
static void hold(avr_t *avr, bool is_down)
{
    avr_ioport_external_t outside = {.name = 'C', .mask = 1u << bit, .value = is_down ? 0 : 1u << bit};
    avr_ioctl(avr, AVR_IOCTL_IOPORT_SET_EXTERNAL('C'), &outside);
    avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ('C'), bit), !is_down);
}

static avr_cycle_count_t on_release(avr_t *avr, avr_cycle_count_t when, void *unused)
{
    (void)when, (void)unused;
    hold(avr, false);
    return 0;
}

static avr_cycle_count_t on_press(avr_t *avr, avr_cycle_count_t when, void *unused)
{
    (void)unused;
    hold(avr, true);
    avr_cycle_timer_register(avr, released_at - when, on_release, NULL);
    return 0;
}

bool button_attach(avr_t *avr, const char *press)
{
    unsigned pin, from_ms, to_ms;
    if (sscanf(press, "%u:%u-%u", &pin, &from_ms, &to_ms) != 3 || pin < FIRST_PIN_OF_PORT_C || to_ms <= from_ms) {
        return false;
    }
    bit = (int)(pin - FIRST_PIN_OF_PORT_C);
    released_at = (avr_cycle_count_t)to_ms * (CLOCK_HZ / 1000);
    hold(avr, false);
    avr_cycle_timer_register(avr, (avr_cycle_count_t)from_ms * (CLOCK_HZ / 1000) + 1, on_press, NULL);
    return true;
}
