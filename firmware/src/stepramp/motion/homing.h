/* Homing: an axis runs to its limit switch, backs off, and comes again slowly; where it sees the switch then is position 0. */
#ifndef STEPRAMP_HOMING_H
#define STEPRAMP_HOMING_H

#include <stdint.h>

#include "stepramp/edge/inputs.h"
#include "stepramp/edge/step_queue.h"

#ifdef __cplusplus
extern "C" {
#endif

#if HAS_INPUTS

/* Begins to home axes at rest. Intervals [ticks]: of the fast approach, with the sign of the direction, one for each axis of the
 * mask, which are written over; and of the slow one. It backs off by at least one step. Returns STATUS_OK, or why not and then changes nothing. */
uint8_t homing_begin(uint8_t axes, int32_t *intervals, uint32_t slow_interval, uint16_t steps_back, uint16_t *detail);

/* They are not any more. What moves goes on until it is stopped. */
void homing_end(uint8_t axes);

/* To be called once the inputs have been looked at. */
void homing_go_on(void);

extern uint8_t stepramp_homing_axes;

#endif

/* The axes that are being homed, a bit each. */
static inline uint8_t axes_homing(void)
{
#if HAS_INPUTS
    return stepramp_homing_axes;
#else
    return 0;
#endif
}

#ifdef __cplusplus
}
#endif

#endif
