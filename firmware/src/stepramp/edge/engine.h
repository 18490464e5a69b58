/* What a board's engine gives besides step_queue.h: it plays the rings of step_rings.h, event by event, and defines them.
 * On an ATmega328P that is an interrupt, the assembly in boards/avr/; elsewhere boards/polled/ does exactly the
 * same. For the step queue's own files, line.c and the engines' tests. */
#ifndef STEPRAMP_ENGINE_H
#define STEPRAMP_ENGINE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* At rest: the line's queue is played instead of the axes', or the axes' again. All queues are empty then. */
void engine_set_line(bool line);

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

/* What a segment of this axis carries in step_mask and turn_mask; never 0. Of a gauge, only that they aren't 0 counts. */
uint8_t engine_step_mask(uint8_t axis);
uint8_t engine_turn_mask(uint8_t axis);

#ifdef __cplusplus
}
#endif

#endif
