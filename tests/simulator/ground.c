/* Pins that something outside connects to ground. */
#include <simavr/avr_ioport.h>

#include "host.h"

enum { FIRST_PIN_OF_PORT_B = 8, FIRST_PIN_OF_PORT_C = 14, PINS = 20 };

static uint8_t used[2], high[2]; /* of ports B and C */

bool ground_has_pin(unsigned pin)
{
    return pin > FIRST_PIN_OF_PORT_B && pin < PINS;
}

/* What is outside holds the pin down; otherwise its own pull-up has it. */
void ground_pin(avr_t *avr, unsigned pin, bool is_down)
{
    unsigned port = pin >= FIRST_PIN_OF_PORT_C, bit = pin - (port ? FIRST_PIN_OF_PORT_C : FIRST_PIN_OF_PORT_B);
    char name = port ? 'C' : 'B';
    used[port] |= (uint8_t)(1u << bit);
    high[port] = (uint8_t)(is_down ? high[port] & ~(1u << bit) : high[port] | 1u << bit);
    avr_ioport_external_t outside = {.name = (unsigned long)name, .mask = used[port], .value = high[port]};
    avr_ioctl(avr, AVR_IOCTL_IOPORT_SET_EXTERNAL(name), &outside);
    avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ(name), bit), !is_down);
}
