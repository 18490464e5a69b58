#include "line.h"

enum { PIECE_BITS = 15 };

struct line line;
struct line_piece line_in_progress;

void line_begin(uint8_t leader, const uint32_t steps[MOST_AXES])
{
    line = (struct line){0};
    line.is_on = true;
    line.leader = leader;
    line.total = steps[leader];
    line.left = line.total;
    uint8_t followers = 0;
    for (uint8_t axis = 0; axis < MOST_AXES; axis++) {
        if (axis != leader && steps[axis] != 0) {
            followers |= (uint8_t)(1u << axis);
            line.followers[line.follower_count] = axis;
            line.steps[line.follower_count] = steps[axis];
            line.rest[line.follower_count] = line.total / 2;
            line.follower_count++;
        }
    }
    line.axes = LINE_AXES(1u << leader, followers);
}

/* The steps of a follower in the next 2^15 of the leader: the whole part of steps * 2^15 / total; what is over is kept
 * for the next piece. Bit by bit, since the product has up to 46 bits. */
static uint16_t share_of_piece(uint8_t follower)
{
    uint32_t over = line.steps[follower];
    uint16_t share = 0;
    for (uint8_t bit = 0; bit <= PIECE_BITS; bit++) {
        share = (uint16_t)(share << 1);
        if (over >= line.total) {
            over -= line.total;
            share |= 1;
        }
        if (bit != PIECE_BITS) {
            over <<= 1;
        }
    }
    line.rest[follower] += over;
    if (line.rest[follower] >= line.total) {
        line.rest[follower] -= line.total;
        share++;
    }
    return share;
}

/* Lays out the next piece: all that is left, if it can be one piece. */
static void begin_piece(void)
{
    bool is_last = line.left <= UINT16_MAX;
    line.queued.total = is_last ? (uint16_t)line.left : 1u << PIECE_BITS;
    line.queued.done = 0;
    line.left -= line.queued.total;
    for (uint8_t i = 0; i < line.follower_count; i++) {
        line.queued.delta[i] = is_last ? (uint16_t)(line.steps[i] - line.queued.made[i]) : share_of_piece(i);
        line.queued.made[i] += line.queued.delta[i];
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
    segment->axes = is_step ? line.axes : 0;
    segment->total = 0;
    if (!is_step) {
        return;
    }
    if (line.queued.done == 0) {
        segment->total = line.queued.total;
        for (uint8_t i = 0; i < MOST_FOLLOWERS; i++) {
            segment->delta[i] = line.queued.delta[i];
        }
    }
    line.queued.done = (uint16_t)(line.queued.done + segment->count_less_1 + 1u);
}

/* Steps of a follower within the piece. */
static uint16_t steps_in_piece(const struct line_piece *piece, uint8_t follower)
{
    if (piece->total == 0) {
        return 0;
    }
    /* At most (2^16 - 1)^2 + 2^15, which is less than 2^32. */
    return (uint16_t)(((uint32_t)piece->done * piece->delta[follower] + piece->total / 2) / piece->total);
}

uint32_t line_steps_of(const struct line_piece *piece, uint8_t follower)
{
    return piece->made[follower] + steps_in_piece(piece, follower);
}

void line_play(struct line_piece *piece, const struct line_segment *segment, uint16_t steps)
{
    if (segment->axes != 0 && segment->total != 0) {
        for (uint8_t i = 0; i < MOST_FOLLOWERS; i++) {
            piece->made[i] += steps_in_piece(piece, i);
            piece->delta[i] = segment->delta[i];
        }
        piece->total = segment->total;
        piece->done = 0;
    }
    piece->done = (uint16_t)(piece->done + steps);
}
