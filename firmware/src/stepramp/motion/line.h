/* A straight line: the axis with most steps leads and plays a ramp, the others make their steps with its. In pieces of
 * at most 2^15 steps, as that is what the engine counts to; each begins and ends within half a step of the line. */
#ifndef STEPRAMP_LINE_H
#define STEPRAMP_LINE_H

#include <stdbool.h>
#include <stdint.h>

#include "stepramp/edge/engine.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A piece of it. */
struct line_piece {
    uint16_t total; /* steps of the leader; 0: none yet */
    uint16_t done;  /* of them, as far as they have been queued, or played */
    uint16_t delta[MOST_FOLLOWERS];
};

/* How far it has been played. */
struct line_progress {
    struct line_piece piece;
    uint32_t made[MOST_FOLLOWERS]; /* steps of the followers in the pieces before */
};

/* An axis whose steps come with the leader's. */
struct follower {
    uint8_t axis;   /* ascending */
    uint32_t steps; /* in all of the line */
    uint32_t rest;  /* of the leader's in all, by which a step more is due: of what has been laid out */
};

struct line {
    bool is_on;
    uint8_t leader;
    uint8_t follower_count;
    uint8_t axes;                /* for LINE_AXES */
    uint32_t left;               /* steps of the leader that are in no piece yet */
    uint32_t total;              /* steps of the leader */
    struct follower followers[MOST_FOLLOWERS];
    struct line_piece queued;
    struct line_progress played; /* and retired */
};

extern struct line stepramp_line;

/* As far as it had been played when feed_progress looked. */
extern struct line_progress stepramp_line_in_progress;

static inline bool line_is_on(void)
{
    return stepramp_line.is_on;
}

/* The axes that make steps, a bit each. */
static inline uint8_t line_axes(void)
{
    return (uint8_t)((stepramp_line.axes | stepramp_line.axes >> 4) & 0x0F);
}

/* At this offset in the line's queue [bytes]. */
static inline struct line_segment *line_segment(uint8_t offset)
{
    return (struct line_segment *)((uint8_t *)stepramp_line_queue + offset);
}

/* Begins a line of the axes that make steps; the leader makes at least one. */
void line_begin(uint8_t leader, const uint32_t steps[MOST_AXES]);

/* Steps that the next segment may have: those left of the piece in hand, or of the next one. */
uint16_t line_most_steps(void);

/* Steps of a follower that come with so many of the leader's. */
uint32_t line_steps_with(uint8_t follower, uint32_t leader_steps);

/* Completes a segment, of the leader's steps or silent, whose count is there. */
void line_fill_in(volatile struct line_segment *segment, bool is_step);

/* A segment of the line has been played, or `steps` of it. */
void line_play(struct line_progress *progress, const struct line_segment *segment, uint16_t steps);

static inline void line_retire(const struct line_segment *segment, uint16_t steps)
{
    line_play(&stepramp_line.played, segment, steps);
}

/* Steps of a follower as far as its line has been played. */
uint32_t line_steps_of(const struct line_progress *progress, uint8_t follower);

#ifdef __cplusplus
}
#endif

#endif
