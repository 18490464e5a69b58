/* The hardware that the portable firmware needs, made of variables: EEPROM, clock, pins and a serial line. */
#ifndef PROTOCOL_PORT_H
#define PROTOCOL_PORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "stepramp/edge/build_options.h"

enum { EEPROM_BYTES = 1024, EEPROM_ERASED = 0xFF, PORT_AXES = 4 };

extern uint8_t port_eeprom[EEPROM_BYTES];
extern long port_eeprom_writes;

/* From the EEPROM write with this number on, counted from 1, none is done; in the middle of that one the power fails,
 * and leaves `port_cut_value` in its byte, or what was there when that is -1. 0: never. */
extern long port_cut_write;
extern int port_cut_value;

/* How long a byte of EEPROM takes to be written [ticks of 16 MHz]. */
extern uint32_t port_eeprom_write_ticks;

/* Steps made by each axis, forward less backward, as the pins show them. */
extern int32_t port_steps[PORT_AXES];

#if HAS_INPUTS
/* The levels of the inputs' pins, a bit each, besides what switches say. A pin that nobody pulls down is high. */
extern uint16_t port_levels;

/* A switch that pulls its pin down while an axis is at `at` or beyond, backward or forward. */
struct port_switch {
    uint8_t input, axis;
    bool backward;
    int32_t at;
};
enum { PORT_SWITCHES = 8 };
extern struct port_switch port_switches[PORT_SWITCHES];
extern uint8_t port_switch_count;

/* The pins' levels may have changed: an edge of an emergency stop is obeyed at once, as in an interrupt. */
void port_look_at_edges(void);
extern bool port_is_tapped; /* the emergency stop, for a moment behind the next look at the inputs */
#endif

/* Switches on: the controller begins. */
void port_begin(void);

/* Lets so much time pass, in rounds as long as a half millisecond: quickly. `out` gets what is sent in it, of which there
 * is room for `most` bytes. Returns their number. */
size_t port_pass(unsigned long milliseconds, uint8_t *out, size_t most);

/* One round of the main loop, a quarter of the time that a byte of the serial line takes. */
void port_round(void);

/* Gives the next byte that is sent. Returns false when there is none. */
bool port_next_byte(uint8_t *byte);

/* Lets so many byte times pass. In the first ones the bytes of `in` arrive; `out` (NULL: nowhere) gets what is sent.
 * Returns the number of bytes sent, at most one a byte time. */
size_t port_run(unsigned long byte_times, const uint8_t *in, size_t in_length, uint8_t *out);

#endif
