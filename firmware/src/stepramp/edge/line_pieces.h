/* A line's segments: between line.c and the step queue. */
#ifndef STEPRAMP_LINE_PIECES_H
#define STEPRAMP_LINE_PIECES_H

#include "stepramp/edge/step_rings.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Completes a segment, of the leader's steps or silent, whose count is there. */
void line_fill_in(volatile struct line_segment *segment, bool is_step);

/* A piece of a line. */
struct line_piece {
    uint16_t total; /* steps of the leader; 0: none yet */
    uint16_t done;  /* of them, as far as they have been queued, or played */
    uint16_t delta[MOST_FOLLOWERS];
};

/* How far a line has been played. */
struct line_progress {
    struct line_piece piece;
    uint32_t made[MOST_FOLLOWERS]; /* steps of the followers in the pieces before */
};

/* As far as it has been taken off the queue, and as far as it had been played when it was looked. */
extern struct line_progress stepramp_line_taken, stepramp_line_looked;

/* A segment has been played, or `steps` of it. */
void line_play(struct line_progress *progress, const struct line_segment *segment, uint16_t steps);

#ifdef __cplusplus
}
#endif

#endif
