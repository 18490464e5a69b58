#include "stepramp/edge/line.h"

#include <string.h>

#include "stepramp/edge/engine.h"
#include "stepramp/edge/line_pieces.h"
#include "stepramp/edge/out_of_line.h"

/* Steps of the leader in a piece, but for the last: as many as an engine counts to. */
static const uint16_t STEPS_OF_A_PIECE = 1u << 15;

/* An axis whose steps come with the leader's. */
struct follower {
    uint8_t axis;   /* ascending */
    uint32_t steps; /* in all of the line */
    uint32_t rest;  /* of the leader's in all, by which a step more is due: of what has been laid out */
};

bool stepramp_line_is_on;

static struct {
    uint8_t leader;
    uint8_t follower_count;
    uint8_t axes;   /* for LINE_AXES */
    uint32_t left;  /* steps of the leader that are in no piece yet */
    uint32_t total; /* steps of the leader */
    struct follower followers[MOST_FOLLOWERS];
    struct line_piece queued;
} line;

struct line_progress stepramp_line_taken, stepramp_line_looked;

void line_begin(uint8_t leader, const uint32_t steps[MOST_AXES])
{
    memset(&line, 0, sizeof line);
    memset(&stepramp_line_taken, 0, sizeof stepramp_line_taken);
    stepramp_line_is_on = true;
    engine_set_line(true);
    line.leader = leader;
    line.total = steps[leader];
    line.left = line.total;
    struct follower *follower = line.followers;
    uint8_t bit = 1;
    for (uint8_t axis = 0; axis < MOST_AXES; axis++, steps++, bit = (uint8_t)(bit << 1)) {
        if (axis == leader) {
            line.axes |= LINE_AXES(bit, 0);
        } else if (*steps != 0) {
            line.axes |= LINE_AXES(0, bit);
            line.follower_count++;
            *follower++ = (struct follower){axis, *steps, line.total / 2};
        }
    }
}

void line_end(void)
{
    stepramp_line_is_on = false;
    engine_set_line(false);
}

uint8_t line_leader(void)
{
    return line.leader;
}

uint8_t line_leader_of(uint8_t axes)
{
    uint8_t leader = line.axes & 0x0F;
    return (axes & (leader | line.axes >> 4)) != 0 ? leader : 0;
}

/* The index of an axis among the followers; MOST_FOLLOWERS: it is none. */
static uint8_t follower_index(uint8_t axis)
{
    const struct follower *follower = line.followers;
    for (uint8_t k = 0; line_is_on() && k < line.follower_count; k++, follower++) {
        if (follower->axis == axis) {
            return k;
        }
    }
    return MOST_FOLLOWERS;
}

bool line_follows(uint8_t axis)
{
    return follower_index(axis) != MOST_FOLLOWERS;
}

/* The steps that a follower makes with some of the leader's: steps * leader_steps / total, and what remains of that is added
 * to `rest`, which makes one step more when it comes to a whole one. Bit by bit, since the product has up to 62 bits: the
 * leader's steps are the topmost `bits` bits. */
static uint32_t share_of(const struct follower *follower, uint32_t leader_steps, uint8_t bits, uint32_t *rest)
{
    uint32_t over = 0, steps = 0;
    uint8_t halves = 2 * bits; /* of a bit: first all is doubled, then what it is worth added; and at the end the rest */
    for (;;) {
        if (halves == 0) {
            over += *rest;
        } else if ((halves & 1) == 0) {
            steps <<= 1;
            over <<= 1;
        } else {
            if ((leader_steps & 1ul << 31) != 0) {
                over += follower->steps;
            }
            leader_steps <<= 1;
        }
        if (over >= line.total) {
            over -= line.total;
            steps++;
        }
        if (halves-- == 0) {
            *rest = over;
            return steps;
        }
    }
}

/* The leader's steps in a piece that begins with so many left. */
static uint16_t piece_of(uint32_t left)
{
    return left < STEPS_OF_A_PIECE ? (uint16_t)left : STEPS_OF_A_PIECE;
}

static uint16_t share_of_piece(const struct follower *follower, uint16_t leader_steps, uint32_t *rest)
{
    return (uint16_t)share_of(follower, (uint32_t)leader_steps << 16, 16, rest);
}

/* Lays out the next piece. */
static void begin_piece(void)
{
    line.queued.total = piece_of(line.left);
    line.queued.done = 0;
    line.left -= line.queued.total;
    struct follower *follower = line.followers;
    for (uint8_t i = 0; i < line.follower_count; i++, follower++) {
        line.queued.delta[i] = share_of_piece(follower, line.queued.total, &follower->rest);
    }
}

uint16_t line_most_steps(void)
{
    if (line.queued.done == line.queued.total && line.left != 0) {
        begin_piece();
    }
    return (uint16_t)(line.queued.total - line.queued.done);
}

void line_fill_in(volatile struct line_segment *segment, bool is_step)
{
    segment->axes = 0;
    segment->total = 0;
    if (!is_step) {
        return;
    }
    segment->axes = line.axes;
    if (line.queued.done == 0) {
        segment->total = line.queued.total;
        for (uint8_t i = 0; i < MOST_FOLLOWERS; i++) {
            segment->delta[i] = line.queued.delta[i];
        }
    }
    line.queued.done = (uint16_t)(line.queued.done + segment->count_less_1 + 1u);
}

/* Steps of a follower with the first `done` of the leader's in a piece in which they make `delta` and `total`. */
static OUT_OF_LINE uint16_t steps_in_piece(uint16_t done, uint16_t delta, uint16_t total)
{
    if (total == 0) {
        return 0;
    }
    /* At most 2^30 + 2^14 */
    return (uint16_t)(((uint32_t)done * delta + total / 2) / total);
}

/* Steps of a follower as far as its line has been played. */
static OUT_OF_LINE uint32_t steps_of(const struct line_progress *progress, uint8_t follower)
{
    const struct line_piece *piece = &progress->piece;
    return progress->made[follower] + steps_in_piece(piece->done, piece->delta[follower], piece->total);
}

uint32_t line_steps_made(uint8_t axis)
{
    uint8_t index = follower_index(axis);
    return index == MOST_FOLLOWERS ? 0 : steps_of(&stepramp_line_looked, index);
}

uint32_t line_steps_with(uint8_t axis, uint32_t leader_steps)
{
    const struct follower *follower = &line.followers[follower_index(axis)];
    if (leader_steps == line.total) { /* most often, and sooner known */
        return follower->steps;
    }
    uint32_t begin = leader_steps - leader_steps % STEPS_OF_A_PIECE;
    uint16_t total = piece_of(line.total - begin);
    uint32_t rest = line.total / 2;
    uint32_t before = share_of(follower, begin, 32, &rest);
    uint16_t delta = share_of_piece(follower, total, &rest);
    return before + steps_in_piece((uint16_t)(leader_steps - begin), delta, total);
}

void line_play(struct line_progress *progress, const struct line_segment *segment, uint16_t steps)
{
    struct line_piece *piece = &progress->piece;
    if (segment->axes != 0 && segment->total != 0) {
        for (uint8_t i = 0; i < MOST_FOLLOWERS; i++) {
            progress->made[i] = steps_of(progress, i);
            piece->delta[i] = segment->delta[i];
        }
        piece->total = segment->total;
        piece->done = 0;
    }
    piece->done = (uint16_t)(piece->done + steps);
}

void line_look(void)
{
    stepramp_line_looked = stepramp_line_taken;
}
