/* A lane: where an axis' segments go, its own queue or, for the axis that leads a straight line, the line's. Both have
 * as many segments, which begin alike; which it is, is the same for all axes. A segment's offset is in bytes. */
#ifndef STEPRAMP_STEP_QUEUE_H
#define STEPRAMP_STEP_QUEUE_H

#include <stdbool.h>
#include <stdint.h>

#include "stepramp/edge/engine.h"
#include "stepramp/edge/queue_layout.h"
#include "stepramp/motion/line.h"

#ifdef __cplusplus
extern "C" {
#endif

/* As they lie together in axis_player and stepramp_line_player. */
struct step_queue {
    volatile uint8_t tail;  /* offset of what is loaded next; the interrupt's */
    volatile uint8_t head;  /* that is filled next */
    volatile uint8_t empty; /* counts the loads that found nothing */
    uint8_t retired;        /* whose steps are counted next */
};

static inline struct step_queue *step_queue_of(uint8_t axis)
{
    return (struct step_queue *)(line_is_on() ? &stepramp_line_player.tail : &stepramp_axis_players[axis].tail);
}

static inline uint8_t step_queue_next(uint8_t offset)
{
    if (line_is_on()) {
        return (uint8_t)(offset + LINE_SEGMENT_BYTES);
    }
    return (uint8_t)((offset & QUEUE_BYTES) | ((offset + QUEUED_SEGMENT_BYTES) & (QUEUE_BYTES - 1)));
}

/* One segment stays free, so that a full lane doesn't look like an empty one. */
static inline bool step_queue_has_room(const struct step_queue *lane)
{
    return step_queue_next(lane->head) != lane->retired;
}

/* Segments that are not loaded yet. */
uint8_t step_queue_ahead(const struct step_queue *lane);

/* Fills the next segment. A line puts steps for all its axes. Turns has a bit for each axis whose direction turns. */
void step_queue_push(uint8_t axis, uint16_t interval, int16_t add, uint16_t count_less_1, bool is_step, uint8_t turns);

/* What is to be known of a segment that has been loaded. */
struct loaded {
    uint16_t time;  /* the timer's value when it was; of one that isn't loaded yet its first interval [ticks] */
    uint16_t steps; /* 0: silent */
    bool turns;
};
void step_queue_loaded(uint8_t axis, uint8_t offset, struct loaded *loaded);

#ifdef __cplusplus
}
#endif

#endif
