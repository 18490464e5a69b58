/* Pins that something outside connects to ground. */
#include <simavr/avr_ioport.h>

#include "host.h"

enum { PORTS = 'L' - 'A' + 1 };

static uint8_t used[PORTS], high[PORTS];

bool ground_has_pin(unsigned pin)
{
    return (int)pin < chip_pins();
}

/* What is outside holds the pin down; otherwise its own pull-up has it. */
void ground_pin(avr_t *avr, unsigned pin, bool is_down)
{
    struct port_bit place = chip_pin((int)pin);
    unsigned port = (unsigned)(place.port - 'A');
    used[port] |= (uint8_t)(1u << place.bit);
    high[port] = (uint8_t)(is_down ? high[port] & ~(1u << place.bit) : high[port] | 1u << place.bit);
    avr_ioport_external_t outside = {.name = (unsigned long)place.port, .mask = used[port], .value = high[port]};
    avr_ioctl(avr, AVR_IOCTL_IOPORT_SET_EXTERNAL(place.port), &outside);
    avr_raise_irq(avr_io_getirq(avr, AVR_IOCTL_IOPORT_GETIRQ(place.port), place.bit), !is_down);
}
