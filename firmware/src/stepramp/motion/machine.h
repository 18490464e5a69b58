/* The machine: up to four axes, each with its ramp, alone, at the same time, or along a straight line. */
#ifndef STEPRAMP_MACHINE_H
#define STEPRAMP_MACHINE_H

#include <stdbool.h>
#include <stdint.h>

#include "stepramp/edge/line.h"
#include "stepramp/edge/out_of_line.h"
#include "stepramp/edge/step_queue.h"
#include "stepramp/motion/feed.h"
#include "stepramp/protocol/message.h"
#include "stepramp/store/driver_settings.h"

#ifdef __cplusplus
extern "C" {
#endif

enum axis_state { AXIS_IDLE = 0, AXIS_MOVING = 1, AXIS_STOPPING = 2 };

struct axis_report {
    uint8_t state;
    int32_t position;    /* [steps] */
    uint32_t steps_made; /* since it last set out from rest */
};

/* Those in use; machine_use sets them. */
extern const struct settings *stepramp_machine_settings;

void machine_begin(void);

/* Uses an image that has been checked and stays as it is until the next call; NULL: none. At rest. */
void machine_use(const uint8_t *image, const struct settings *settings);

/* Axes of the image in use; 0 without one. */
uint8_t machine_axes(void);

/* Or is being homed: between two stages of that an axis is at rest. */
bool machine_is_moving(void);

static inline bool machine_is_on_a_line(void)
{
    return line_is_on();
}

/* Each returns STATUS_OK, or why not and then changes nothing; arrays have a value for each axis of the mask, in their order.
 * Without a ramp: STATUS_NO_RAMP. */
uint8_t machine_move_to(uint8_t axes, const int32_t *targets, uint16_t *detail);
uint8_t machine_run(uint8_t axes, const int32_t *intervals, uint16_t *detail);
uint8_t machine_line(uint8_t axes, uint8_t ramp_axis, const int32_t *steps, uint16_t *detail);
uint8_t machine_zero(uint8_t axes, uint16_t steps, uint16_t *detail);

/* At rest. */
void machine_set_position(uint8_t axes, const int32_t *positions);

/* Slow down with the ramp. A line stops as a whole, when one of its axes is among them. */
void machine_stop(uint8_t axes);

/* The same, of those that run at a speed, without a target. */
void machine_stop_runs(void);

/* No step comes after this; the positions stay known. A line as a whole, likewise. */
void machine_halt(uint8_t axes);

struct axis_report machine_report(uint8_t axis);

/* [ticks] The present one of an axis; 0 at rest, and of one that a line's leader takes along. */
uint32_t machine_interval(uint8_t axis);

/* One axis, alone or on a line: sooner known than all of its report. */
bool machine_axis_is_moving(uint8_t axis);

/* At a speed, without a target. */
bool machine_runs(uint8_t axis);

/* [steps] Where the motor will come to rest; while it runs at a speed, and at rest, its position. */
int32_t machine_target(uint8_t axis);

/* Where an axis is, that follows no line: in less room on the stack than all that machine_report() tells. */
int32_t machine_position(uint8_t axis);

/* How often a queue ran dry in a move since the start; 255 stays 255. */
static inline uint8_t machine_starved(void)
{
    return feed_starved();
}

bool machine_is_enabled(void);

/* To be called in each round of the main loop. Returns true when there is time for other things. */
OUT_OF_LINE bool machine_poll(void);

#ifdef __cplusplus
}
#endif

#endif
