/* The edge between motion and hardware: a queue of segments for each axis, or one for all axes of a straight line
 * (line.h). Motion pushes segments and asks what of them has been played; how a board keeps and plays them is its own
 * affair, and so is everything below this file.
 *
 * An axis is parked, running or halted. It begins parked. `step_queue_start` makes it run. When it has to load a segment
 * and its queue is empty, it parks itself: no event comes any more, also when segments are pushed later, until it is
 * started again. `step_queue_halt` stops it between two events, whatever is left to play. */
#ifndef STEPRAMP_STEP_QUEUE_H
#define STEPRAMP_STEP_QUEUE_H

#define MOST_AXES 4

/* Longest interval of an event [ticks]. Times are compared modulo 2^16: well below half of that. */
#define LONGEST_WAIT_TICKS 30000

#ifndef __ASSEMBLER__

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- the board gives these ---- */

/* All axes parked and their queues empty, the timer at its fast clock, no line. */
void step_queue_begin(void);

/* At rest: ticks of 1/16 us, or else of 1/2 us. */
void step_queue_set_clock(bool fast);

/* Starts those of the axes (a bit each) that don't run and whose queues hold a segment. They have their first event, a
 * silent one that loads the first segment, all at the same tick, 20 us from now or a little later; the first event of
 * that segment comes `setup_ticks` (1..LONGEST_WAIT_TICKS) after it. A line is started by its leader. */
void step_queue_start(uint8_t axes, uint16_t setup_ticks);

/* From its return on these axes have no event. What they played stays readable. A pulse is never cut short. A line
 * halts as a whole. */
void step_queue_halt(uint8_t axes);

/* Parks axes that don't run, and empties their queues. */
void step_queue_clear(uint8_t axes);

/* ---- filling ---- */

bool step_queue_has_room(uint8_t axis);

/* Segments that are not loaded yet. */
uint8_t step_queue_ahead(uint8_t axis);

/* Adds a segment: count_less_1 + 1 events, which toggle the step pin or are silent, each followed by its interval, the
 * first `interval` long, each next one longer by `add` [ticks]. `turns` has a bit for each axis whose direction turns
 * when the segment is loaded: the axis itself, on a line others, too. On a line the axis is its leader. Only when there is
 * room. */
void step_queue_push(uint8_t axis, uint16_t interval, int16_t add, uint16_t count_less_1, bool is_step, uint8_t turns);

/* ---- what has been played ---- */

struct step_played {
    uint16_t steps;
    uint16_t time; /* the timer's value at the last event, where `has_time` [ticks] */
    bool has_time;
    bool turned; /* the axis' direction */
};

/* Takes the oldest segment off that has been played to its end. Returns false when there is none. */
bool step_queue_take(uint8_t axis, struct step_played *played);

/* Steps and turn of all that has been played and not been taken off yet, up to now. */
void step_queue_played(uint8_t axis, struct step_played *played);

/* Since its start it has found its queue empty, and parked itself. */
bool step_queue_has_parked(uint8_t axis);

/* An interval of events that are steps, or silent. */
struct step_interval {
    uint16_t ticks;
    bool is_step;
};

/* The interval that is passing. */
struct step_interval step_queue_passing(uint8_t axis);

/* The first interval of the next segment to be loaded; no step when there is none. */
struct step_interval step_queue_next(uint8_t axis);

#ifdef __cplusplus
}
#endif

#endif

#endif
