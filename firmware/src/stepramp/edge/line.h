/* A straight line: the axis with most steps leads and plays a ramp, the others make their steps with its. In pieces of
 * at most 2^15 steps, as that is what an engine counts to; each begins and ends within half a step of the line. */
#ifndef STEPRAMP_LINE_H
#define STEPRAMP_LINE_H

#include "stepramp/edge/step_queue.h"

#define MOST_FOLLOWERS (MOST_AXES - 1)

#ifndef __ASSEMBLER__

#ifdef __cplusplus
extern "C" {
#endif

extern bool stepramp_line_is_on;

static inline bool line_is_on(void)
{
    return stepramp_line_is_on;
}

/* At rest: begins a line of the axes that make steps; the leader makes at least one. Its segments are pushed from now on. */
void line_begin(uint8_t leader, const uint32_t steps[MOST_AXES]);

/* It has come to rest: the axes have queues of their own again. */
void line_end(void);

uint8_t line_leader(void);

/* Axes are a bit each: the leader, when one of these makes steps of the line, else none. */
uint8_t line_leader_of(uint8_t axes);

/* The axis makes its steps with the leader's, in the line that is on. */
bool line_follows(uint8_t axis);

/* Steps that the next segment may have: those left of the piece in hand, or of the next one. 0: all have been pushed. */
uint16_t line_most_steps(void);

/* Steps of a follower that come with so many of the leader's. */
uint32_t line_steps_with(uint8_t axis, uint32_t leader_steps);

/* Looks how far the line has been played; step_queue_played of the leader does the same. */
void line_look(void);

/* Steps that an axis had made as a follower when it was looked; 0 when it is none. */
uint32_t line_steps_made(uint8_t axis);

#ifdef __cplusplus
}
#endif

#endif

#endif
