/* The feed: what an axis plans on its way into the axis' queue, and what of the queue has been played. */
#ifndef STEPRAMP_FEED_H
#define STEPRAMP_FEED_H

#include <stdbool.h>
#include <stdint.h>

#include "stepramp/edge/out_of_line.h"
#include "stepramp/edge/step_queue.h"
#include "stepramp/motion/axis.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How far a motor has come. */
struct feed_progress {
    int32_t position;    /* [steps] */
    uint32_t steps_made; /* since it last set out from rest */
    bool backward;       /* the direction pin */
};

/* Belongs to the main loop. */
struct feed {
    struct feed_progress played; /* all that has left the queue */
    uint16_t parts_left; /* of a long interval, still to be queued as silent segments */
    uint16_t end_time;   /* [64 us] when the queue will be empty; before the start, its length */
    uint16_t end_ticks;  /* and so many fast ticks */
    uint8_t index;      /* of the axis */
    uint8_t bit;        /* of the axis */
    uint8_t stage;      /* enum feed_stage */
    uint8_t turns_too;  /* other axes, a bit each, that turn together with this one */
    bool is_traced : 1;     /* in this move */
    bool has_got_ahead : 1; /* the queue was as long as needed, in this move */
    bool turns_next : 1;    /* a silence in which the direction may turn comes next */
    bool has_pulses : 1;    /* queued since the last silence at rest */
    bool has_stepped : 1;   /* since the last start, as far as that has been counted */
    bool has_run_dry : 1;   /* the queue, in the middle of a move; since the last start */
    bool pin_backward : 1;  /* the direction pin, at the end of the queue */
    bool has_ramped : 1;    /* steps of a ramp have been queued since it was idle */
    struct axis axis;   /* last: an AVR reaches the first 64 bytes best */
};

enum feed_stage {
    FEED_IDLE,    /* at rest; the queue is empty and parked */
    FEED_WAITING, /* queued for a start */
    FEED_PLAYING
};

/* What the feeds of all axes go by. */
struct feed_clock {
    uint16_t now;         /* [64 us] */
    uint32_t setup_ticks; /* from the direction to the pulse; set at rest, like the next */
    bool is_fast;         /* the engine's clock */
};

extern struct feed_clock stepramp_feed_clock;

static inline bool feed_is_moving(const struct feed *feed)
{
    return feed->stage != FEED_IDLE;
}

/* Begins to move an axis that is idle. */
void feed_set_out(struct feed *feed);

/* Goes on, for a short time, with an axis that isn't idle. Returns false when its queue is still short: then nothing else
 * should be done for long. */
OUT_OF_LINE bool feed_poll(struct feed *feed);

/* It has made a step since the last start: before that it waits for it, or for the direction to settle. */
bool feed_has_stepped(const struct feed *feed);

/* A waiting feed has enough for a start: as much as is queued ahead later, or all that there is. */
bool feed_is_ready(const struct feed *feed);

/* Its queue has been started, whose first segment comes so many ticks from now. */
void feed_started(struct feed *feed, uint16_t start_ticks);

/* Its queue has been halted, whose segments are still as they were: what hasn't been played is forgotten. */
void feed_halted(struct feed *feed);

/* How far the motor has come now, also told in place of what has been played. The line that it leads has been looked at then. */
void feed_progress(const struct feed *feed, struct feed_progress *progress);

/* [ticks] of an axis that isn't idle: the interval that is passing, or the next one; 0 before the first step and after
 * the last. */
uint32_t feed_interval(const struct feed *feed);

/* [ticks] at least, where a step is made; 0 where none is, and of an axis that is idle. */
uint16_t feed_step_interval(const struct feed *feed);

#if COUNTS_LATENESS
/* What is queued is played later by so much [256 ticks]. */
void feed_be_late(struct feed *feed, uint8_t late);
#endif

/* How often a queue ran dry in a move; 255 stays 255. */
uint8_t feed_starved(void);

#ifdef __cplusplus
}
#endif

#endif
