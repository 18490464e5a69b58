/* The places of segments in the rings: between step_queue_filled.c and step_queue_played.c. */
#ifndef STEPRAMP_STEP_PLACES_H
#define STEPRAMP_STEP_PLACES_H

#include "stepramp/edge/step_rings.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where an axis' segments go: into its own ring or, for the axis that leads a straight line, the line's. Both have as many
 * segments, which begin alike; which it is, is the same for all axes. A segment's offset is in bytes. The ends lie together
 * like this in axis_player and line_player. */
struct ring_ends {
    volatile uint8_t tail;  /* offset of what is loaded next; the engine's */
    volatile uint8_t head;  /* that is filled next */
    volatile uint8_t empty; /* counts the loads that found nothing since the start */
    uint8_t retired;        /* whose steps are counted next */
};

struct ring_ends *step_places_ends(uint8_t axis);

/* The offset after another one. */
uint8_t step_places_after(uint8_t offset);

/* What a segment begins with: [ticks] its first interval or, once it is loaded, the timer's value then. */
uint16_t step_places_time(uint8_t axis, uint8_t offset);

/* Reads a segment as if it had been played to its end. Its time is as above. */
void step_places_read(uint8_t axis, uint8_t offset, struct step_played *segment);

static inline struct line_segment *step_places_line(uint8_t offset)
{
    return (struct line_segment *)((uint8_t *)stepramp_line_queue + offset);
}

#ifdef __cplusplus
}
#endif

#endif
