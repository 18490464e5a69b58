/* A machine's inputs, where a build has them: what a board gives. An input is a bit by its number; what it is for, and which
 * level is its active one, its role says (driver_settings.h). */
#ifndef STEPRAMP_INPUTS_H
#define STEPRAMP_INPUTS_H

#include <stdbool.h>
#include <stdint.h>

#include "stepramp/edge/build_options.h"

#ifdef __cplusplus
extern "C" {
#endif

/* So many inputs there are, and the first of them can be emergency stops. */
enum { INPUTS = 9, EMERGENCY_INPUTS = 6 };

#if HAS_INPUTS

/* The inputs that are at their active levels at this moment. */
uint16_t inputs_read(void);

/* The emergency stop: once it is latched no axis has an event, and none is started, until it is released. A board latches it in the
 * interrupt of an input's edge. What was queued and played stays readable, as after a halt. */
bool emergency_is_latched(void);
void emergency_latch(void);

/* Does nothing while an emergency stop's input is active. */
void emergency_release(void);

#endif

#ifdef __cplusplus
}
#endif

#endif
