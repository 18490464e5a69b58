/* What a machine's inputs do to its axes: they stop them, and keep them from setting out; and whose position is known. Where a
 * build has no inputs nothing of it is there. */
#ifndef STEPRAMP_MACHINE_INPUTS_H
#define STEPRAMP_MACHINE_INPUTS_H

#include "stepramp/edge/inputs.h"
#include "stepramp/motion/feed.h"
#include "stepramp/store/driver_settings.h"

#ifdef __cplusplus
extern "C" {
#endif

#if HAS_INPUTS

/* What has stopped all axes, bits. */
enum stopped_by { BY_EMERGENCY_STOP = 1, BY_DRIVER_FAULT = 2, BY_LATENESS = 4 };

/* In place of an input's number where there is none: and of a switch where a soft limit is in the way. */
enum { NO_INPUT = 0xFF, LOWEST_POSITION = 0xFE, HIGHEST_POSITION = 0xFF };

/* The settings' roles are in use from now on. */
void machine_inputs_configure(void);

/* The engine's clock is set: how late steps may be from now on. */
void machine_lateness_configure(void);

/* To be called in each round of the main loop, which has little time when motors are at their limits. */
void machine_watch_inputs(uint16_t now_ms);

/* Those that are active, a bit each. */
uint16_t machine_active_inputs(void);

/* By what, and not acknowledged: bits of enum stopped_by. */
uint8_t machine_stopped_by(void);

/* By an emergency stop, which may be there still: what its input is for stays as it is until then. */
bool machine_is_in_emergency(void);

/* Which input is an emergency stop that is active, by a role that it didn't have before; EMERGENCY_INPUTS: none. */
uint8_t machine_new_stop(const uint8_t before[INPUTS], const uint8_t roles[INPUTS]);

/* Motions are taken again. Returns false when what stopped them is still there. */
bool machine_acknowledge(void);

/* Something keeps the axis from setting out, one way or the other. */
bool machine_way_may_be_blocked(uint8_t axis);

/* Whether a motion of an axis may set out: STATUS_OK, STATUS_STOPPED or STATUS_AT_LIMIT. */
uint8_t machine_check_way(uint8_t axis, bool backward, uint16_t *detail);

/* [steps] An axis' soft limit, or where positions end: there are none as long as its position isn't known. */
int32_t machine_soft_limit(uint8_t axis, bool backward);

static inline bool is_no_limit(int32_t position, bool backward)
{
    return position == (backward ? NO_LOWEST : NO_HIGHEST);
}

/* Whether an axis may come to rest there, or run that way from where it is: STATUS_OK or STATUS_AT_LIMIT. `interval`: with
 * the sign of the direction; 0: a stop. */
uint8_t machine_check_end(uint8_t axis, int32_t end, uint16_t *detail);
uint8_t machine_check_run(uint8_t axis, int32_t interval, uint16_t *detail);

/* Whether an axis at rest may go so many steps on a line: STATUS_OK or what keeps it. */
uint8_t machine_check_part(uint8_t axis, bool backward, uint32_t steps, uint16_t *detail);

#ifdef ARDUINO
/* Of several axes, to places or at intervals. An axis that stays where it is isn't kept from it by a limit. */
uint8_t machine_check_ways(uint8_t mask, const int32_t *values, bool is_run, uint16_t *detail);

/* A run ends at a soft limit, if there is one. */
void machine_end_run(struct feed *feed, bool backward);

/* Where a motor is that was halted faster than its ramp begins nobody knows. */
void machine_forget_fast(uint8_t mask);
#endif

/* The number of an active limit switch at that end of the axis, or NO_INPUT. */
uint8_t machine_limit_at(uint8_t axis, bool backward);

/* An axis has a limit switch at that end. */
bool machine_has_limit(uint8_t axis, bool backward);

/* That switch is active at this moment, seen once. */
bool machine_sees_limit(uint8_t axis, bool backward);

/* The axes whose position is known, a bit each. */
extern uint8_t stepramp_known_positions;

#endif

#ifdef __cplusplus
}
#endif

#endif
