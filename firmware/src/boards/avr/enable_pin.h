/* The pin that enables all drivers. It outlives a reset by the watchdog. */
#ifndef STEPRAMP_ENABLE_PIN_H
#define STEPRAMP_ENABLE_PIN_H

#include <stdint.h>

/* The level that the enable pin is driven to, or that it isn't driven. Kept so that after a reset by the watchdog the
 * pin is driven again before anything else happens: drivers that let go would let motors coast. */
enum enable_level { ENABLE_NOT_DRIVEN = 0, ENABLE_LOW = 1, ENABLE_HIGH = 2 };

/* Drives the enable pin, or lets go of it, and remembers it. */
void enable_pin_drive(uint8_t level);

/* As remembered. */
uint8_t enable_pin_level(void);

#endif
