/* How segments lie in the rings that a board's engine plays: known to it and to the step queue's own files, and to nobody else. The main
 * loop fills a ring, the engine empties it.
 *
 * A segment is so many events. An event toggles the step pin (or is silent), and `interval` ticks later comes the next
 * one; the interval grows by `add` after each. A long interval is an event followed by silent ones, so that the engine
 * needs no more than 16 bits. The layout is known to the assembly in boards/avr/. */
#ifndef STEPRAMP_STEP_RINGS_H
#define STEPRAMP_STEP_RINGS_H

#include "stepramp/edge/build_options.h"
#include "stepramp/edge/line.h"
#include "stepramp/edge/step_queue.h"

#define QUEUED_SEGMENT_BYTES 8
#define AXIS_PLAYER_BYTES 13

#define LINE_SEGMENTS 16
#define LINE_SEGMENT_BYTES 16
#define LINE_QUEUE_BYTES 256

#ifndef __ASSEMBLER__

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

/* What the engine plays of an axis. */
struct axis_player {
    uint16_t due; /* [ticks] timer value of the next event */
    uint16_t interval;
    int16_t add;
    uint16_t count_less_1; /* events of this segment after the next one */
    uint8_t step_mask;
    volatile uint8_t tail;  /* low byte of the offset of the next segment to load, in the queue; the engine's */
    volatile uint8_t head;  /* offset of the first free segment; the main loop's */
    volatile uint8_t empty; /* counts the loads that found nothing since the start: then the axis is parked */
    uint8_t retired;        /* offset of the segment whose events are counted next; the main loop's */
};

extern struct axis_player stepramp_axis_players[MOST_AXES];
extern struct queued_segment stepramp_queues[MOST_AXES][QUEUE_SEGMENTS];

/* Where RAM is short there is no queue of the line: it is the memory of the axes' queues, as one or the other is in use. */
#ifdef STEPRAMP_SHARED_QUEUES
#define LINE_SEGMENT_ATTRIBUTES __attribute__((may_alias))
#define stepramp_line_queue ((struct line_segment *)stepramp_queues)
#else
#define LINE_SEGMENT_ATTRIBUTES
#endif

/* ---- a straight line ----
 *
 * One or more axes lead: they step at each event. Up to three followers step at some of the same events.
 * A piece of a line is one or more segments. Its first has total != 0: so many steps the leaders make in all of the
 * piece, and delta[k] <= total of them are steps of follower k too. The m-th of them comes with the leaders' step
 * ceil(total * (2 m - 1) / (2 delta[k])). Segments with total == 0 go on with the piece and have its followers; their delta doesn't
 * count. In a silent segment no axis leads or follows: its followers wait. */
struct LINE_SEGMENT_ATTRIBUTES line_segment {
    uint16_t interval; /* as in queued_segment, also once it is loaded */
    int16_t add;
    uint16_t count_less_1;
    uint16_t total;
    uint16_t delta[MOST_FOLLOWERS]; /* of the followers in the order of their axes, then 0 */
    uint8_t axes;                   /* LINE_AXES(leaders, followers) */
    uint8_t turn_axes;              /* a bit for each axis whose direction turns when this is loaded */
};

/* Axes are a bit each. */
#define LINE_AXES(leaders, followers) ((uint8_t)((leaders) | (followers) << 4))

/* In a piece with so many steps of the leaders, `total`, and `delta` of its own. */
struct line_follower {
    int16_t wait_add; /* delta: added to `due` where it doesn't step with the leaders */
    int16_t step_add; /* delta - total: where it does */
    int16_t due;      /* it steps next when this is not negative */
};

struct line_player {
    uint16_t interval;
    int16_t add;
    uint16_t count_less_1;
    struct line_follower followers[MOST_FOLLOWERS];
    uint8_t follower_pins[MOST_FOLLOWERS];
    uint8_t pins;         /* of the next event: worked out one event ahead, so that all of them rise together */
    uint8_t leader_pins;  /* 0: silent */
    volatile uint8_t tail;  /* offset in the queue of the next segment to load; the engine's */
    volatile uint8_t head;  /* offset of the first free segment; the main loop's */
    volatile uint8_t empty; /* counts the loads that found nothing since the start: then the line is parked */
    uint8_t retired;        /* the main loop's */
};

extern struct line_player stepramp_line_player;
#ifndef STEPRAMP_SHARED_QUEUES
extern struct line_segment stepramp_line_queue[LINE_SEGMENTS];
#endif

#ifdef __cplusplus
}
#endif

#endif

#endif
