#include "stepramp/motion/feed.h"

#include "stepramp/edge/board.h"
#include "stepramp/edge/build_options.h"
#include "stepramp/edge/line.h"
#include "stepramp/edge/out_of_line.h"
#include "stepramp/edge/step_queue.h"
#include "stepramp/motion/machine_inputs.h"
#include "stepramp/protocol/trace.h"

/* A long interval is waited for in parts: the first has what is left of it, 13,616 ticks or more, the others are equal.
 * So many of them go as one segment, 4 or 8 ms: else slow axes would need more segments than fast ones. */
enum { PART_BITS = 14, PART_TICKS = 1 << PART_BITS, FAST_PARTS = 4, SLOW_PARTS = 1 };

/* The silence after the last interval of a move [ticks]: in it the engine finds the queue empty, or the direction may
 * be changed. */
enum { CLOSING_TICKS = 400 };

/* Segments queued, or looked at ahead of need, in one round of the main loop, at most: other axes want theirs too. */
enum { SEGMENTS_AT_ONCE = 4 };

/* Ticks of 64 us, and of a slow tick, as powers of 2. */
enum { FAST_BITS = 10, SLOW_TICK_BITS = 3 };

/* The longest piece of several steps [ticks]: some 4 ms. So none of their intervals is a long one. */
enum { FAST_PIECE_TICKS = 2u * LONGEST_WAIT_TICKS, SLOW_PIECE_TICKS = 8000 };

/* [64 us] Time to queue ahead: 8 ms (in a sketch TICKS_AHEAD says more), enough for the main loop's longest round when interrupts take nearly all of the
 * processor, and little enough to begin a stop soon. With less than HURRY_TIME, 4 ms and still longer than such a round,
 * something must be queued now. */
enum { TIME_AHEAD = TICKS_AHEAD, HURRY_TIME = 62 };

/* [64 us] With so much in the queue, 6 ms, it can wait until other things have been done: the queues of other axes, a
 * request and a stop. A trace makes segments short, which takes time, so it needs more of it. */
enum { WAITING_TIME = TICKS_AHEAD - 29, TRACING_TIME = TICKS_AHEAD - 25 };

/* With so much in the queue of a line, 5 ms, a stop is read first: to read it, answer it and turn to the ramp down takes 4 ms
 * of a line of four at its highest speed. One axis queues for all, and is soon asked again. */
enum { LINE_WAITING_TIME = TICKS_AHEAD - 46 };

/* A segment is loaded at the beginning of the interval before it, so that some must be there however long that is: where
 * the direction turns, the silence that ends a move, that in which the direction settles, a pulse, and the next. */
enum { LEAST_SEGMENTS = 4 };

struct feed_clock stepramp_feed_clock;
static uint8_t starved;

/* Of the axis that is traced: pulses until the next one whose time is traced, at both ends of the queue. */
static uint16_t trace_to_queue, trace_to_play;

/* Pulses until the next one whose time is traced, after some more of them. Those that the queue has no end at are left
 * out. Never more than `every`, so that 16 bits hold it. */
static uint16_t trace_left(const struct feed *feed, uint16_t left, uint16_t pulses)
{
    uint16_t every = trace_every(feed->index);
    while (every != 0 && left <= pulses) {
        pulses = (uint16_t)(pulses - left);
        left = every;
    }
    return (uint16_t)(left - pulses);
}

/* ---- filling the queue ---- */

/* `count` intervals, the first `interval` long, each next one longer by `add` [ticks]. */
static uint32_t length_of(uint16_t interval, int16_t add, uint16_t count)
{
    uint32_t length = (uint32_t)count * interval;
    if (add != 0) {
        length += (uint32_t)add * (((uint32_t)count * (uint16_t)(count - 1u)) >> 1);
    }
    return length;
}

/* Moves the end of the queue on. One segment is less than 2^24 fast ticks. */
static OUT_OF_LINE void extend(struct feed *feed, uint32_t ticks)
{
    if (!stepramp_feed_clock.is_fast) {
        ticks <<= SLOW_TICK_BITS;
    }
    ticks += feed->end_ticks;
    feed->end_time = (uint16_t)(feed->end_time + ((uint16_t)(ticks >> 8) >> (FAST_BITS - 8)));
    feed->end_ticks = (uint16_t)ticks & ((1u << FAST_BITS) - 1u);
}

/* Of a long interval the first part; the rest becomes parts_left. */
static void queue_up(struct feed *feed, const struct piece *piece, uint8_t turns)
{
    uint16_t interval = (uint16_t)piece->interval;
    if (piece->interval > LONGEST_WAIT_TICKS) {
        uint32_t rest = piece->interval - (LONGEST_WAIT_TICKS - PART_TICKS);
        feed->parts_left = (uint16_t)(rest << (16 - PART_BITS) >> 16);
        interval = (uint16_t)(interval - (feed->parts_left << PART_BITS));
    }
    extend(feed, length_of(interval, piece->add, piece->count));
    step_queue_push(feed->index, interval, piece->add, (uint16_t)(piece->count - 1u), piece->kind == PIECE_STEPS, turns);
}

static void queue_silence(struct feed *feed, uint32_t ticks, uint16_t count, uint8_t turns)
{
    struct piece silence = {.kind = PIECE_NONE, .count = count, .interval = ticks};
    queue_up(feed, &silence, turns);
}

static void queue_wait(struct feed *feed)
{
    uint8_t most = stepramp_feed_clock.is_fast ? FAST_PARTS : SLOW_PARTS;
    uint16_t parts = feed->parts_left < most ? feed->parts_left : most;
    feed->parts_left = (uint16_t)(feed->parts_left - parts);
    queue_silence(feed, PART_TICKS, parts, 0);
}

static void queue_steps(struct feed *feed, const struct piece *piece)
{
    queue_up(feed, piece, 0);
    feed->has_pulses = true;
    if (feed->axis.phase != PHASE_LEVEL) {
        feed->has_ramped = true;
    }
    if (feed->is_traced) {
        trace_to_queue = trace_left(feed, trace_to_queue, piece->count);
    }
}

/* The silence before the pulses, in which the direction settles. */
static void queue_turn(struct feed *feed)
{
    uint8_t turns = feed->turns_too;
    if (feed->pin_backward != feed->axis.backward) {
        turns |= feed->bit;
    }
    feed->pin_backward = feed->axis.backward;
    feed->turns_too = 0;
    feed->turns_next = false;
    queue_silence(feed, stepramp_feed_clock.setup_ticks, 1, turns);
}

/* Ends what has been queued of a move. */
static void queue_closing(struct feed *feed)
{
    feed->has_pulses = false;
    queue_silence(feed, CLOSING_TICKS, 1, 0);
}

/* Time for which steps are queued [64 us]. */
static OUT_OF_LINE uint16_t time_ahead(const struct feed *feed, uint16_t now)
{
    uint16_t ahead = feed->end_time;
    if (feed->stage == FEED_PLAYING) {
        ahead = (uint16_t)(ahead - now);
    }
    return ahead <= INT16_MAX ? ahead : 0; /* it is past */
}

/* The steps that one segment may have. A trace is left out when the queue becomes short of it. */
static uint16_t most_steps(const struct feed *feed)
{
    bool has_time = !feed->has_got_ahead || time_ahead(feed, board_time()) >= TRACING_TIME;
    uint16_t most = feed->is_traced && has_time ? trace_to_queue : UINT16_MAX;
    if (line_is_on()) {
        uint16_t line_most = line_most_steps();
        most = line_most < most ? line_most : most;
    }
    return most;
}

/* Returns false when the move has been queued to its end. */
static bool queue_next_piece(struct feed *feed, uint16_t ahead)
{
    struct piece piece;
    piece.most_ticks = stepramp_feed_clock.is_fast ? FAST_PIECE_TICKS : SLOW_PIECE_TICKS;
    piece.most_steps = most_steps(feed);
    piece.in_a_hurry = feed->stage == FEED_PLAYING && ahead < HURRY_TIME;
    if (piece.most_steps == 0) { /* a line ends where it was meant to */
        axis_halt(&feed->axis, feed->axis.position);
    }
    axis_next(&feed->axis, &piece);
    if (piece.kind == PIECE_STEPS) {
        queue_steps(feed, &piece);
    } else if (piece.kind != PIECE_NONE) {
        feed->turns_next = piece.kind == PIECE_SET_OUT;
        if (!feed->has_pulses) {
            return feed->turns_next;
        }
        queue_closing(feed);
    }
    return true;
}

static bool is_needed(const struct feed *feed, uint16_t ahead)
{
    return step_queue_has_room(feed->index) && (ahead < TIME_AHEAD || step_queue_ahead(feed->index) < LEAST_SEGMENTS);
}

/* Queues one segment, or looks for what later ones take. Returns false when there is nothing to do. */
static bool fill(struct feed *feed)
{
    uint16_t ahead = time_ahead(feed, stepramp_feed_clock.now);
    if (!is_needed(feed, ahead)) {
        feed->has_got_ahead = true;
        return axis_look_ahead(&feed->axis);
    }
    if (feed->parts_left != 0) {
        queue_wait(feed);
    } else if (feed->turns_next) {
        if (feed->stage == FEED_PLAYING) {
            return false; /* a move begins with more than may still be queued in time: from the next start on */
        }
        queue_turn(feed);
    } else {
        return queue_next_piece(feed, ahead);
    }
    return true;
}

/* ---- what has been played ---- */

static void trace_played(const struct feed *feed, const struct step_played *segment)
{
    if (!feed->is_traced || segment->steps == 0) {
        return;
    }
    bool is_traced = segment->steps == trace_to_play;
    trace_to_play = trace_left(feed, trace_to_play, segment->steps);
    if (is_traced && segment->has_time) {
        trace_value(feed->index, feed->played.steps_made, segment->time);
    }
}

static void count(struct feed_progress *progress, const struct step_played *played)
{
    progress->backward = progress->backward != played->turned;
    axis_move_position(&progress->position, progress->backward, played->steps);
    progress->steps_made += played->steps;
}

/* Counts the oldest segment that has been played. Returns false when there is none. */
static bool retire(struct feed *feed)
{
    struct step_played segment;
    if (!step_queue_take(feed->index, &segment)) {
        return false;
    }
    count(&feed->played, &segment);
    if (segment.steps != 0) {
        feed->has_stepped = true;
    }
    trace_played(feed, &segment);
    return true;
}

/* Other things can be done first, as steps are queued for `least` [64 us]. */
static bool can_wait(const struct feed *feed, uint8_t least)
{
    return feed->stage != FEED_PLAYING || time_ahead(feed, board_time()) >= least || !step_queue_has_room(feed->index);
}

/* Retires what has been played: one segment when a stop waits, and not so many that nothing is queued meanwhile. */
static void retire_played(struct feed *feed)
{
    for (uint8_t left = SEGMENTS_AT_ONCE; left != 0 && retire(feed); left--) {
        if (board_skip_to_stop()) {
            return;
        }
    }
}

/* ---- for the machine ---- */

void feed_set_out(struct feed *feed)
{
    if (feed->stage != FEED_IDLE) {
        return;
    }
    feed->stage = FEED_WAITING;
    feed->end_time = 0;
    feed->end_ticks = 0;
    feed->played.steps_made = 0;
    trace_begin_move(feed->index);
    feed->is_traced = trace_every(feed->index) != 0;
    feed->has_got_ahead = false;
    feed->has_ramped = false;
    if (feed->is_traced) {
        trace_to_queue = 1; /* the first pulse */
        trace_to_play = 1;
    }
}

bool feed_is_ready(const struct feed *feed)
{
    bool is_all = step_queue_ahead(feed->index) != 0 && axis_is_at_rest(&feed->axis) && !feed->has_pulses;
    return is_all || !is_needed(feed, time_ahead(feed, stepramp_feed_clock.now));
}

void feed_started(struct feed *feed, uint16_t start_ticks)
{
    extend(feed, start_ticks);
    feed->end_time = (uint16_t)(feed->end_time + stepramp_feed_clock.now);
    feed->has_run_dry = false;
    feed->has_stepped = false;
    feed->stage = FEED_PLAYING;
}

bool feed_has_stepped(const struct feed *feed)
{
    if (feed->stage != FEED_PLAYING) {
        return false;
    }
    struct step_played played;
    step_queue_played(feed->index, &played);
    return feed->has_stepped || played.steps != 0;
}

void feed_halted(struct feed *feed)
{
    feed_progress(feed, &feed->played);
    feed->pin_backward = feed->played.backward;
    feed->stage = FEED_IDLE;
    feed->parts_left = 0;
    feed->turns_next = false;
    feed->has_pulses = false;
    axis_halt(&feed->axis, feed->played.position);
    trace_end_move(feed->index);
}

/* Nothing is left to do, and nothing queued. */
static bool is_done(const struct feed *feed)
{
    return axis_is_at_rest(&feed->axis) && feed->parts_left == 0 && !feed->turns_next && step_queue_ahead(feed->index) == 0;
}

static void become_idle(struct feed *feed)
{
    feed->stage = FEED_IDLE;
#if HAS_INPUTS
    feed->axis.runs = false; /* it has come to a soft limit */
    if (feed->axis.seeks_zero) {
        feed->axis.seeks_zero = false;
        stepramp_known_positions |= feed->bit;
    }
#endif
    trace_end_move(feed->index);
}

/* The queue has been found empty: at rest, or in a move. */
static void parked(struct feed *feed)
{
    while (retire(feed)) {
    }
    if (is_done(feed)) {
        become_idle(feed);
        return;
    }
    /* The end of the move may have been queued since. */
    bool has_run_dry = feed->has_pulses || step_queue_next(feed->index).is_step;
    feed->has_run_dry = has_run_dry;
    if (has_run_dry && starved != UINT8_MAX) {
        starved++;
    }
#if HAS_INPUTS
    if (has_run_dry) {
        stepramp_known_positions &= line_is_on() ? 0 : (uint8_t)~feed->bit;
        feed->axis.seeks_zero = false;
    }
#endif
    feed->stage = FEED_WAITING;
    feed->end_time = 0;
    feed->end_ticks = 0;
}

/* To a stop. What only looks like one comes as often as a disturbed line makes it: an axis that has little time left queues
 * something first. */
static bool gives_way(const struct feed *feed)
{
    return can_wait(feed, line_is_on() ? LINE_WAITING_TIME : WAITING_TIME) && board_skip_to_stop();
}

bool feed_poll(struct feed *feed)
{
    if (feed->stage == FEED_PLAYING) {
        retire_played(feed);
        if (step_queue_has_parked(feed->index)) {
            parked(feed);
            return true;
        }
    } else if (is_done(feed)) { /* the target was taken back before the start */
        become_idle(feed);
        return true;
    }
    bool has_time = true;
    for (uint8_t left = SEGMENTS_AT_ONCE; left != 0 && !gives_way(feed) && fill(feed); left--) {
        has_time = can_wait(feed, WAITING_TIME);
        if (has_time && left < SEGMENTS_AT_ONCE) {
            break;
        }
    }
    /* So that little is left to be looked for at a stop. */
    for (uint8_t left = SEGMENTS_AT_ONCE; has_time && left != 0 && feed->axis.phase == PHASE_UP && !board_skip_to_stop(); left--) {
        if (!axis_look_ahead(&feed->axis)) {
            break;
        }
    }
    return has_time;
}

void feed_progress(const struct feed *feed, struct feed_progress *progress)
{
    *progress = feed->played;
    if (feed->stage == FEED_PLAYING) {
        struct step_played played;
        step_queue_played(feed->index, &played);
        count(progress, &played);
    } else {
        line_look();
    }
}

static bool is_part(struct step_interval interval)
{
    return !interval.is_step && interval.ticks == PART_TICKS;
}

/* Of a long interval the queue has the parts, of which the first is a step's. As a whole the axis knows only the one queued last. Where
 * that isn't long, only so much is known as that this one is. */
uint32_t feed_interval(const struct feed *feed)
{
    struct step_interval passing = step_queue_passing(feed->index);
    if (is_part(passing.is_step ? step_queue_next(feed->index) : passing)) {
        return feed->axis.interval > LONGEST_WAIT_TICKS ? feed->axis.interval : LONGEST_WAIT_TICKS + 1u;
    }
    return passing.is_step ? passing.ticks : 0; /* other silences are none */
}

uint16_t feed_step_interval(const struct feed *feed)
{
    struct step_interval passing = step_queue_passing(feed->index);
    return feed->stage == FEED_PLAYING && passing.is_step ? passing.ticks : 0;
}

#if COUNTS_LATENESS
void feed_be_late(struct feed *feed, uint8_t late)
{
    extend(feed, (uint16_t)((uint16_t)late << 8));
}
#endif

uint8_t feed_starved(void)
{
    return starved;
}
