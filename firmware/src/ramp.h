/* A ramp, unpacked. */
#ifndef STEPRAMP_RAMP_H
#define STEPRAMP_RAMP_H

#include <stdint.h>

#include "limits.h"

#ifdef __cplusplus
extern "C" {
#endif

/* An interval [ticks], at most LONGEST_INTERVAL_TICKS: 24 bits where the compiler has such a type, which saves time in
 * the step interrupt and a byte a segment. Sums and differences are modulo its size. */
#ifdef __UINT24_MAX__
typedef __uint24 interval_t;
#else
typedef uint32_t interval_t;
#endif

/* `count` intervals, each `add` ticks longer than the one before. The first is `change` ticks longer than the interval
 * with which the segment before it would go on (0 before the first segment). So a list can be played in both directions
 * without a multiplication, which the step interrupt has no time for. */
struct segment {
    interval_t change; /* [ticks] modulo the size of interval_t */
    int16_t add;       /* [ticks] */
    uint16_t count;    /* at least 1 */
};

/* A list of segments, from its slow end on. */
struct segment_list {
    const struct segment *segments;
    uint8_t length;
    uint32_t steps;           /* the sum of all counts */
    interval_t last_interval; /* 0 when the list is empty */
};

/* How far into a list: its first `segments` segments, of the last of them `last_count` intervals. */
struct reach {
    uint8_t segments;
    uint16_t last_count;
    interval_t last_interval; /* 0 when there is none */
    uint32_t steps;           /* the same, counted in intervals */
};

struct ramp {
    struct segment segments[MOST_SEGMENTS];
    struct segment_list up;   /* from the first interval of a move on */
    struct segment_list down; /* from the last interval of a move backwards; may be the same list as up */
    interval_t slew_interval;
};

/* Interval number `index`, from 0, of a segment whose first is `first` [ticks]; `index` may be one past the last. */
static inline uint32_t segment_interval(uint32_t first, const struct segment *segment, uint16_t index)
{
    return first + (uint32_t)((int32_t)segment->add * index);
}

#ifdef __cplusplus
}
#endif

#endif
