/* The inputs' pins. */
#ifndef STEPRAMP_AVR_INPUTS_H
#define STEPRAMP_AVR_INPUTS_H

#include "stepramp/store/driver_settings.h"

#if HAS_INPUTS
/* With the pins of port B, or without, where gauges have them. */
void inputs_configure(const struct settings *settings, bool has_port_b);
#endif

#endif
