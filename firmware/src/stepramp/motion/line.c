#include "stepramp/motion/line.h"

#include "stepramp/edge/out_of_line.h"

/* Steps of the leader in a piece, but for the last: as many as the engine counts to. */
static const uint16_t STEPS_OF_A_PIECE = 1u << 15;

struct line stepramp_line;
struct line_progress stepramp_line_in_progress;

void line_begin(uint8_t leader, const uint32_t steps[MOST_AXES])
{
    stepramp_line = (struct line){0};
    stepramp_line.is_on = true;
    stepramp_line.leader = leader;
    stepramp_line.total = steps[leader];
    stepramp_line.left = stepramp_line.total;
    struct follower *follower = stepramp_line.followers;
    uint8_t bit = 1;
    for (uint8_t axis = 0; axis < MOST_AXES; axis++, steps++, bit = (uint8_t)(bit << 1)) {
        if (axis == leader) {
            stepramp_line.axes |= LINE_AXES(bit, 0);
        } else if (*steps != 0) {
            stepramp_line.axes |= LINE_AXES(0, bit);
            stepramp_line.follower_count++;
            *follower++ = (struct follower){axis, *steps, stepramp_line.total / 2};
        }
    }
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
        if (over >= stepramp_line.total) {
            over -= stepramp_line.total;
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
    stepramp_line.queued.total = piece_of(stepramp_line.left);
    stepramp_line.queued.done = 0;
    stepramp_line.left -= stepramp_line.queued.total;
    struct follower *follower = stepramp_line.followers;
    for (uint8_t i = 0; i < stepramp_line.follower_count; i++, follower++) {
        stepramp_line.queued.delta[i] = share_of_piece(follower, stepramp_line.queued.total, &follower->rest);
    }
}

uint16_t line_most_steps(void)
{
    if (stepramp_line.queued.done == stepramp_line.queued.total && stepramp_line.left != 0) {
        begin_piece();
    }
    return (uint16_t)(stepramp_line.queued.total - stepramp_line.queued.done);
}

void line_fill_in(volatile struct line_segment *segment, bool is_step)
{
    segment->axes = 0;
    segment->total = 0;
    if (!is_step) {
        return;
    }
    segment->axes = stepramp_line.axes;
    if (stepramp_line.queued.done == 0) {
        segment->total = stepramp_line.queued.total;
        for (uint8_t i = 0; i < MOST_FOLLOWERS; i++) {
            segment->delta[i] = stepramp_line.queued.delta[i];
        }
    }
    stepramp_line.queued.done = (uint16_t)(stepramp_line.queued.done + segment->count_less_1 + 1u);
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

uint32_t line_steps_of(const struct line_progress *progress, uint8_t follower)
{
    const struct line_piece *piece = &progress->piece;
    return progress->made[follower] + steps_in_piece(piece->done, piece->delta[follower], piece->total);
}

uint32_t line_steps_with(uint8_t index, uint32_t leader_steps)
{
    const struct follower *follower = &stepramp_line.followers[index];
    if (leader_steps == stepramp_line.total) { /* most often, and sooner known */
        return follower->steps;
    }
    uint32_t begin = leader_steps - leader_steps % STEPS_OF_A_PIECE;
    uint16_t total = piece_of(stepramp_line.total - begin);
    uint32_t rest = stepramp_line.total / 2;
    uint32_t before = share_of(follower, begin, 32, &rest);
    uint16_t delta = share_of_piece(follower, total, &rest);
    return before + steps_in_piece((uint16_t)(leader_steps - begin), delta, total);
}

void line_play(struct line_progress *progress, const struct line_segment *segment, uint16_t steps)
{
    struct line_piece *piece = &progress->piece;
    if (segment->axes != 0 && segment->total != 0) {
        for (uint8_t i = 0; i < MOST_FOLLOWERS; i++) {
            progress->made[i] = line_steps_of(progress, i);
            piece->delta[i] = segment->delta[i];
        }
        piece->total = segment->total;
        piece->done = 0;
    }
    piece->done = (uint16_t)(piece->done + steps);
}
