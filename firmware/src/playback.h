/* Shared between player.c, the main loop's side of a move, and playback.c, the interrupt's. For no one else. */
#ifndef STEPRAMP_PLAYBACK_H
#define STEPRAMP_PLAYBACK_H

#include <stdbool.h>
#include <stdint.h>

#include "ramp.h"

#ifdef __cplusplus
extern "C" {
#endif

enum phase { PHASE_UP, PHASE_SLEW, PHASE_DOWN };

/* What the main loop wants of the interrupt. */
enum request {
    REQUEST_NONE,
    REQUEST_HOLD, /* no interval shorter than the one before it */
    REQUEST_TURN  /* that, and go down along `turn` after the next interval, unless the way down has begun already */
};

/* A part of a move: `left` intervals, the first `interval` long, each next one longer by `add`, or, on the way down,
 * which plays its segments backwards, shorter by `add`. */
struct run {
    interval_t interval;
    int16_t add; /* [ticks] */
    uint16_t left;
};

/* A way down: its first run, what of the list lies below that, and its number of steps. */
struct way {
    struct run run;
    const struct segment *segment; /* in which the first run lies */
    uint8_t segments_left;         /* below it */
    uint32_t steps;
};

/* Belongs to the interrupt while moving, but for `request` and `turn`. Most of it isn't volatile, for the interrupt's
 * speed; the main loop reads that through volatile pointers. */
struct playback {
    struct run run;                 /* of which run.interval comes next; left == 0: the move has no more intervals */
    const struct segment *segment;  /* up: the next one to load. Down: the one that is being played */
    const volatile struct way *way; /* to take after the last slew interval: planned_way or turn */
    uint8_t segments_left;          /* still to load from the list */
    uint8_t phase;
    bool pulse_is_due;        /* at the next event */
    interval_t present;       /* that is passing */
    interval_t wait_left;     /* of a long interval, after the next event */
    interval_t slew_interval; /* of this move */
    uint32_t slew_left;       /* slew intervals not yet loaded */
    uint16_t up_last_count;   /* intervals of the last segment of the way up */
    uint16_t pulses;          /* counts up and over: the main loop counts the steps with it */
    struct way planned_way;
    volatile bool moving;
    volatile uint8_t request;      /* written by the main loop; the interrupt ends a turn with it */
    volatile struct way turn;      /* written by the main loop before REQUEST_TURN */
    volatile uint16_t turn_pulses; /* `pulses` when the turn was taken; then the request is none again */
};

extern struct playback playback;

/* Makes the first run of a move ready, when all that it needs is. */
void playback_load_first_run(void);

#ifdef __cplusplus
}
#endif

#endif
