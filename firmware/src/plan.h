/* Planning a move: how far into its two lists it goes. No loop here runs once a step, only once a segment, since a
 * motor waits meanwhile. */
#ifndef STEPRAMP_PLAN_H
#define STEPRAMP_PLAN_H

#include <stdbool.h>
#include <stdint.h>

#include "ramp.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Intervals in the order in which they are played: up to `up`, `slew_steps` slew intervals, from `down` backwards. */
struct plan {
    struct reach up;
    uint32_t slew_steps;
    struct reach down;
};

/* Plans a move of at least one step. The two lists grow together from their slow ends, always the one whose next
 * interval is longer, up first when they are equal. */
void plan_move(const struct ramp *ramp, uint32_t steps, struct plan *plan);

/* A list walked from its slow end, a stretch at a time: some intervals of one segment that never become longer. An
 * interval that is longer than one before it counts as that one: nothing may overtake the shorter one before it. */
struct walk {
    const struct segment_list *list;
    uint8_t segment;   /* index of the segment in which the stretch lies */
    uint32_t first;    /* [ticks] the first interval of that segment */
    uint16_t taken;    /* intervals of that segment before the stretch */
    uint16_t count;    /* intervals of the stretch; 0 at the end of the list */
    uint16_t fall;     /* [ticks] by which each is shorter than the one before */
    uint32_t interval; /* [ticks] the first */
    uint32_t shortest; /* [ticks] the shortest before the stretch */
    uint32_t steps;    /* intervals of the list before the stretch */
    uint32_t last;     /* [ticks] the last of them, as it is; 0 when there is none */
};

void walk_begin(struct walk *walk, const struct segment_list *list);

/* Goes on over the intervals that are longer than `bound` ticks, at most to the end of the stretch. Returns false when
 * there are no more of them. */
bool walk_on_while_longer(struct walk *walk, uint32_t bound);

/* How far the walk has come. */
struct reach walk_reach(const struct walk *walk);

#ifdef __cplusplus
}
#endif

#endif
