/* $title
 *
 * Method $method in $arithmetic, rounded: $rounding. F $timer_hz Hz, v0 $base_speed, v $slew_speed steps/s,
 * a $acceleration, d $deceleration steps/s^2$shape.
 * A segment is `count` intervals in ticks of F, the first `interval` long, each next one `add` longer. Both lists begin
 * at the slow end: ${name}_up with the first interval of a move, ${name}_down with the last. No interval is more than
 * $bound from what is planned.
 *
 *     struct ${name}_move move;
 *     ${name}_begin(&move, 1000);                   at rest; the direction is up to you
 *     while ((ticks = ${name}_next(&move)) != 0)    one pulse, then wait so long; 0: the move is over
 *         pulse_and_wait(ticks);
 */
#ifndef $guard
#define $guard

#include <stdint.h>

#define ${prefix}_TIMER_HZ $timer_hz
#define ${prefix}_SLEW $slew

typedef $ticks_type ${name}_ticks; /* an interval in whole ticks */

struct ${name}_segment {
    ${name}_ticks interval;
    uint16_t count;
    int16_t add;
};

/* The last one of each list, without intervals, is its end. */
static const struct ${name}_segment ${name}_up[] = {
$up_lines
    {0, 0, 0},
};
static const struct ${name}_segment ${name}_down[] = {
$down_lines
    {0, 0, 0},
};

/* A cursor in a list: so many intervals into a segment. */
struct ${name}_cursor {
    const struct ${name}_segment *segment;
    uint16_t at;
};

static inline ${name}_ticks ${name}_interval(struct ${name}_cursor cursor)
{
    return (${name}_ticks)(($signed_type)cursor.segment->interval + ($signed_type)cursor.segment->add * cursor.at);
}

static inline int ${name}_is_end(struct ${name}_cursor cursor)
{
    return cursor.segment->count == 0;
}

static inline void ${name}_advance(struct ${name}_cursor *cursor)
{
    if (++cursor->at == cursor->segment->count) {
        cursor->segment++;
        cursor->at = 0;
    }
}

static inline void ${name}_go_back(struct ${name}_cursor *cursor)
{
    if (cursor->at == 0) {
        cursor->segment--;
        cursor->at = cursor->segment->count;
    }
    cursor->at--;
}

struct ${name}_move {
    struct ${name}_cursor up, down;
    uint32_t steps_up, steps_slew, steps_down; /* still to come */
};

/* Takes the slowest intervals of both lists together: they grow from their slow ends, the longer of the two next ones is
 * taken, that of the acceleration when they are equal. What is left over runs at slew speed. */
static inline void ${name}_begin(struct ${name}_move *move, uint32_t steps)
{
    ${name}_ticks least_up = $ticks_max, least_down = $ticks_max; /* the slower one blocks those behind it */
    move->up.segment = ${name}_up;
    move->down.segment = ${name}_down;
    move->up.at = move->down.at = 0;
    move->steps_up = move->steps_down = 0;
    for (move->steps_slew = steps; move->steps_slew != 0; move->steps_slew--) {
        const int up_ends = ${name}_is_end(move->up), down_ends = ${name}_is_end(move->down);
        if (up_ends && down_ends) break;
        if (!up_ends && ${name}_interval(move->up) < least_up) least_up = ${name}_interval(move->up);
        if (!down_ends && ${name}_interval(move->down) < least_down) least_down = ${name}_interval(move->down);
        if (down_ends || (!up_ends && least_up >= least_down)) {
            ${name}_advance(&move->up);
            move->steps_up++;
        } else {
            ${name}_advance(&move->down);
            move->steps_down++;
        }
    }
    move->up.segment = ${name}_up;
    move->up.at = 0;
}

static inline ${name}_ticks ${name}_next(struct ${name}_move *move)
{
    ${name}_ticks interval;
    if (move->steps_up != 0) {
        move->steps_up--;
        interval = ${name}_interval(move->up);
        ${name}_advance(&move->up);
        return interval;
    }
    if (move->steps_slew != 0) {
        move->steps_slew--;
        return ${prefix}_SLEW;
    }
    if (move->steps_down == 0) return 0;
    move->steps_down--;
    ${name}_go_back(&move->down);
    return ${name}_interval(move->down);
}

#endif
