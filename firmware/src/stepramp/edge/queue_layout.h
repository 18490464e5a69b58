/* What is played next: a queue of segments for each axis. The main loop fills it, the step interrupt empties it.
 *
 * A segment is so many events. An event toggles the step pin (or is silent), and `interval` ticks later comes the next
 * one; the interval grows by `add` after each. A long interval is an event followed by silent ones, so that the interrupt
 * needs no more than 16 bits. The layout is known to the assembly in avr/. */
#ifndef STEPRAMP_QUEUE_LAYOUT_H
#define STEPRAMP_QUEUE_LAYOUT_H

#ifdef ARDUINO
#include "boards/polled/arduino_limits.h"
#endif

#define MOST_AXES 4
#define QUEUED_SEGMENT_BYTES 8
#ifndef QUEUE_SEGMENTS
#define QUEUE_SEGMENTS 16
#define QUEUE_BYTES 128
#endif
#define AXIS_PLAYER_BYTES 13

/* Longest interval of an event [ticks]. Times are compared modulo 2^16: well below half of that. */
#define LONGEST_WAIT_TICKS 30000

#ifndef __ASSEMBLER__

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct queued_segment {
    uint16_t interval; /* [ticks] the first. Once loaded: the timer's value at the event that loaded it */
    int16_t add;       /* [ticks] */
    uint16_t count_less_1;
    uint8_t step_mask; /* the step pin's bit, or 0: silent */
    uint8_t turn_mask; /* the direction pin's bit, to be toggled when this is loaded, or 0 */
};

/* What the interrupt plays of an axis. */
struct axis_player {
    uint16_t due; /* [ticks] timer value of the next event */
    uint16_t interval;
    int16_t add;
    uint16_t count_less_1; /* events of this segment after the next one */
    uint8_t step_mask;
    volatile uint8_t tail;  /* low byte of the offset of the next segment to load, in the queue; the interrupt's */
    volatile uint8_t head;  /* offset of the first free segment; the main loop's */
    volatile uint8_t empty; /* counts the loads that found nothing: then the axis is parked */
    uint8_t retired;        /* offset of the segment whose events are counted next; the main loop's */
};

extern struct axis_player stepramp_axis_players[MOST_AXES];
extern struct queued_segment stepramp_queues[MOST_AXES][QUEUE_SEGMENTS];

#ifdef __cplusplus
}
#endif

#endif

#endif
