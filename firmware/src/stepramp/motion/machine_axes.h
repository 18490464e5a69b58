/* The axes of the machine, between the files of machine.h. */
#ifndef STEPRAMP_MACHINE_AXES_H
#define STEPRAMP_MACHINE_AXES_H

#include "stepramp/motion/feed.h"

#ifdef __cplusplus
extern "C" {
#endif

extern struct feed stepramp_feeds[MOST_AXES];
extern uint8_t stepramp_axis_count;   /* of the image */
extern const uint8_t *stepramp_image; /* in use, or NULL */

/* Of a line. */
struct feed *machine_leader(void);

uint8_t machine_ticks_a_us(void);

uint32_t machine_without_sign(int32_t number);

/* The axes of the mask are there and have pins: STATUS_OK, or why not. */
uint8_t machine_check_mask(uint8_t mask, uint16_t *detail);

/* At rest: all directions forward, whatever was queued of turns. */
void machine_make_pins_ready(void);

/* Begins with an axis at rest where it is, with its own ramp. */
void machine_begin_axis(struct feed *feed);

/* The line has come to rest: its axes are axes of their own again. */
void machine_end_line(void);

#ifdef __cplusplus
}
#endif

#endif
