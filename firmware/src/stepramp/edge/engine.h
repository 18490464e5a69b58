/* The engine: plays the queues of queue_layout.h, event by event. On an ATmega328P that is an interrupt, the assembly in
 * boards/avr/; elsewhere boards/polled/engine.c does exactly the same (see the end of this file).
 *
 * An axis is parked, running or halted. It begins parked. `engine_start` makes it run; when it has to load a segment and
 * its queue is empty, it parks itself and counts that in `empty`: no event comes any more, also when segments are
 * queued later, until it is started again. `engine_halt` stops it between two events, whatever is left to play.
 *
 * The engine defines the players and the queues. The line's queue lies where the axes' queues are: one or the other is in
 * use. */
#ifndef STEPRAMP_ENGINE_H
#define STEPRAMP_ENGINE_H

#include "stepramp/edge/queue_layout.h"

#define MOST_FOLLOWERS 3
#define LINE_SEGMENTS 16
#define LINE_SEGMENT_BYTES 16
#define LINE_QUEUE_BYTES 256

#ifndef __ASSEMBLER__

#ifdef __cplusplus
extern "C" {
#endif

/* All axes parked and their queues empty, the timer at its fast clock, no line. */
void engine_begin(void);

/* At rest: ticks of 1/16 us, or else of 1/2 us. */
void engine_set_clock(bool fast);

/* At rest: the line's queue is played instead of the axes', or the axes' again. All queues are empty then. */
void engine_set_line(bool line);

/* Starts those of the axes (a bit each) that don't run and whose queues hold a segment. They have their first event, a
 * silent one that loads the first segment, all at the same tick, 20 us from now or a little later; the first event of
 * that segment comes `setup_ticks` (1..LONGEST_WAIT_TICKS) after it. A line has no axes: any bit starts it. */
void engine_start(uint8_t axes, uint16_t setup_ticks);

/* From its return on these axes have no event. What they played stays readable. A pulse is never cut short. A line
 * halts as a whole. */
void engine_halt(uint8_t axes);

/* Parks axes that don't run, and empties their queues (head = retired = tail). */
void engine_park(uint8_t axes);

/* The axes that run, a bit each; a line counts as bit 0. */
uint8_t engine_running(void);

/* The timer [ticks]. It counts on at rest. */
uint16_t engine_now(void);

/* Where an axis is in its queue, read at one instant while it runs: `count_less_1 + 1` events are left of the segment
 * before `tail`. When it is parked, none are, and count_less_1 is 0 all the same. In line mode: the line's, for any axis. */
struct engine_progress {
    uint16_t count_less_1;
    uint8_t tail;
    uint8_t empty;
};
struct engine_progress engine_progress(uint8_t axis);

/* Where RAM is short, boards/polled/engine.c has no queue of the line: it is the memory of the axes' queues. */
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
    volatile uint8_t tail;  /* offset in the queue of the next segment to load; the interrupt's */
    volatile uint8_t head;  /* offset of the first free segment; the main loop's */
    volatile uint8_t empty; /* counts the loads that found nothing: then the line is parked */
    uint8_t retired;        /* the main loop's */
};

extern struct line_player stepramp_line_player;
#ifndef STEPRAMP_SHARED_QUEUES
extern struct line_segment stepramp_line_queue[LINE_SEGMENTS];
#endif

/* ---- boards/polled/engine.c only: the same engine with a timer that you read and pins that you move ----
 *
 * Where there is a clock but no such interrupt, call `engine_play` often with the time in ticks of your own choice, for
 * instance micros(), at least once in 30,000 ticks. It is not reentrant: don't call it and the functions above from an
 * interrupt and outside of it. */

/* Called at each event with a step, with the bits of the axes that make one: make their pulses. And when directions
 * turn. `engine_now` tells the tick of the event, which may be past. NULL: nothing is called. */
void engine_set_outputs(void (*step)(uint8_t axes), void (*turn)(uint8_t axes));

/* It is `now`: plays all events up to then in their order. Returns the ticks from `now` to the next one; when no axis
 * runs, LONGEST_WAIT_TICKS. */
uint16_t engine_play(uint16_t now);

#ifdef __cplusplus
}
#endif

#endif

#endif
