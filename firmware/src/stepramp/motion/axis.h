/* An axis: the motion of a motor along its ramp, decided piece by piece, each where the last one ends. So target, speed or
 * a stop may change at any moment. Nothing here knows of timers and pins; all of it belongs to the main loop. */
#ifndef STEPRAMP_AXIS_H
#define STEPRAMP_AXIS_H

#include <stdbool.h>
#include <stdint.h>

#include "stepramp/edge/build_options.h"
#include "stepramp/motion/formula.h"
#include "stepramp/motion/ramp_cursor.h"
#include "stepramp/store/ramp_image.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Intervals that are computed at a time. */
enum { FORMULA_BATCH = 6 };

enum axis_phase {
    PHASE_REST,
    PHASE_UP,    /* along the ramp up */
    PHASE_LEVEL, /* at slew speed, or at the speed of a run */
    PHASE_DOWN   /* along the ramp down */
};

struct axis {
    int32_t position;    /* [steps] after the last piece */
    int32_t target;      /* [steps] where it will come to rest; of a run only its sign counts, which is the direction */
    uint32_t interval;   /* [ticks] the last one; 0 at rest */
    uint32_t shortest;   /* [ticks] since the speed began to rise: the ramp down from here has the longer intervals */
    uint32_t level;      /* [ticks] interval of the commanded speed: the ramp's slew interval, or a longer one */
    uint32_t down_steps; /* of the whole ramp down */
    uint8_t phase; /* enum axis_phase */
    uint8_t batch_left;
    bool is_by_formula : 1;
    bool is_slewing : 1; /* the commanded speed is the ramp's slew speed */
    bool backward : 1;
    bool stopping : 1; /* to rest, which has been asked for */
    bool runs : 1; /* at a speed, without a target that was asked for */
    bool ends : 1; /* a run, at a target all the same: a soft limit */
    bool seeks_zero : 1; /* its position is known once it has come to its target, which is 0 */
    union {
        struct {
            struct packed_list up_list;
            struct packed_list down_list;
            struct ramp_cursor up;   /* before the next interval of the ramp up, or after that: on the ramp down */
            struct ramp_cursor down; /* after the next interval of the ramp down, or before that: not looked for yet */
        };
        struct {
            const uint8_t *constants;
            struct formula_state formula;
            uint32_t next; /* [ticks] the first interval of the batch that has not been given, `batch_left` in all */
            int16_t adds[FORMULA_BATCH - 1]; /* [ticks] by which each of the batch is longer than the one before */
            uint8_t batch_size;
        };
    };
};

enum piece_kind {
    PIECE_NONE,    /* nothing yet: ask again */
    PIECE_STEPS,   /* `count` pulses, each followed by its interval */
    PIECE_SET_OUT, /* the motor is at rest, and its next pulses go in the direction that `backward` now has */
    PIECE_REST     /* the motor is at rest at its target */
};

struct piece {
    /* what may be given */
    uint16_t most_ticks; /* a single interval may be longer */
    uint16_t most_steps; /* at least 1 */
    bool in_a_hurry;     /* it is needed at once: the speed is held rather than nothing given */
    /* what is given */
    uint8_t kind;      /* enum piece_kind */
    uint16_t count;    /* [steps] */
    uint32_t interval; /* [ticks] the first */
    int16_t add;       /* [ticks] each next one is so much longer */
};

/* At rest at position 0. */
void axis_begin(struct axis *axis, const struct image_ramp *ramp);

/* What comes next. Takes a short time: where more is to be looked for, it gives PIECE_NONE. */
void axis_next(struct axis *axis, struct piece *piece);

/* To be called in each round of the main loop, from a place where the stack is not deep: computes what axis_next will
 * give, when the ramp is one by formula. */
void axis_compute(struct axis *axis);

/* To be called when there is time: looks ahead of need for the ramp down, and on that for the ramp back up. Returns true
 * when there is more to look for. */
bool axis_look_ahead(struct axis *axis);

/* Go to a position, at the ramp's slew interval [ticks]. */
void axis_move_to(struct axis *axis, uint32_t slew_interval, int32_t target);

/* Go on and on, past the last position to the first, with this interval [ticks]: the ramp's slew interval or a longer one. */
void axis_run(struct axis *axis, bool backward, uint32_t interval, bool is_slewing);

/* Slow down to rest: the target becomes where that is. Its ramp down is looked for to the end, which takes a short time
 * as it is near. */
void axis_stop(struct axis *axis);

/* At rest from now on, at a position that it had before its last pieces. */
void axis_halt(struct axis *axis, int32_t position);

#if HAS_INPUTS
/* A run that has just been asked for comes to rest at this position at the latest. It lies ahead. */
void axis_end_run(struct axis *axis, int32_t end);
#endif

/* It goes on and on. */
static inline bool axis_is_endless(const struct axis *axis)
{
    return axis->runs && !(HAS_INPUTS && axis->ends);
}

static inline bool axis_is_by_formula(const struct axis *axis)
{
    return HAS_FORMULAS && axis->is_by_formula;
}

#if HAS_INPUTS
/* The direction of its next step, or of its last where it is about to turn. */
bool axis_goes_backward(const struct axis *axis);

/* [ticks] The longest interval of its ramp up: slower it may be halted without losing a step. */
uint32_t axis_slowest(const struct axis *axis);
#endif

/* Moves a position by some steps, past the last one to the first. */
void axis_move_position(int32_t *position, bool backward, uint32_t steps);

/* The same of steps with a sign. Returns false when that is where the range has been left. */
bool axis_add_steps(int32_t *position, int32_t steps);

/* It stays where it is: axis_next would give PIECE_REST. */
bool axis_is_at_rest(const struct axis *axis);

#ifdef __cplusplus
}
#endif

#endif
