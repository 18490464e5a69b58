/* A lane: where an axis' segments go, its own queue or, for the axis that leads a straight line, the line's. Both have
 * as many segments, which begin alike; which it is, is the same for all axes. A segment's offset is in bytes. */
#ifndef STEPRAMP_LANE_H
#define STEPRAMP_LANE_H

#include <stdbool.h>
#include <stdint.h>

#include "engine.h"
#include "line.h"
#include "queue.h"

#ifdef __cplusplus
extern "C" {
#endif

/* As they lie together in axis_player and line_player. */
struct lane {
    volatile uint8_t tail;  /* offset of what is loaded next; the interrupt's */
    volatile uint8_t head;  /* that is filled next */
    volatile uint8_t empty; /* counts the loads that found nothing */
    uint8_t retired;        /* whose steps are counted next */
};

static inline struct lane *lane_of(uint8_t axis)
{
    return (struct lane *)(line_is_on() ? &line_player.tail : &axis_players[axis].tail);
}

static inline uint8_t lane_next(uint8_t offset)
{
    if (line_is_on()) {
        return (uint8_t)(offset + LINE_SEGMENT_BYTES);
    }
    return (uint8_t)((offset & QUEUE_BYTES) | ((offset + QUEUED_SEGMENT_BYTES) & (QUEUE_BYTES - 1)));
}

/* One segment stays free, so that a full lane doesn't look like an empty one. */
static inline bool lane_has_room(const struct lane *lane)
{
    return lane_next(lane->head) != lane->retired;
}

/* Segments that are not loaded yet. */
uint8_t lane_ahead(const struct lane *lane);

/* Fills the next segment. A line puts steps for all its axes. Turns has a bit for each axis whose direction turns. */
void lane_put(uint8_t axis, uint16_t interval, int16_t add, uint16_t count_less_1, bool is_step, uint8_t turns);

/* What is to be known of a segment that has been loaded. */
struct loaded {
    uint16_t time;  /* the timer's value when it was; of one that isn't loaded yet its first interval [ticks] */
    uint16_t steps; /* 0: silent */
    bool turns;
};
void lane_loaded(uint8_t axis, uint8_t offset, struct loaded *loaded);

#ifdef __cplusplus
}
#endif

#endif
