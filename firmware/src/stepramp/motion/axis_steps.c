#include "stepramp/motion/axis_steps.h"

uint32_t axis_steps_left(const struct axis *axis)
{
    if (axis_is_endless(axis)) {
        return axis->backward == (axis->target < 0) ? INT32_MAX : 0;
    }
    uint32_t distance = (uint32_t)axis->target - (uint32_t)axis->position;
    bool is_ahead = (axis->target > axis->position) != axis->backward;
    return !is_ahead ? 0 : axis->backward ? 0u - distance : distance;
}

bool axis_is_too_fast(const struct axis *axis)
{
    return !axis->is_slewing && axis->interval != 0 && axis->interval < axis->level;
}

/* Intervals of `longest` ticks that fit, no more than `count`, at least one. The division is avoided where it can be:
 * it takes longer than all else. */
static uint16_t fit(uint16_t ticks, uint32_t longest, uint16_t count)
{
    if (longest >= ticks) {
        return 1;
    }
    if ((uint32_t)count * (uint16_t)longest <= ticks) {
        return count;
    }
    return ticks / (uint16_t)longest;
}

void axis_fit_steps(struct piece *piece, uint32_t interval, int16_t add, uint32_t count)
{
    uint16_t most = count < piece->most_steps ? (uint16_t)count : piece->most_steps;
    most = fit(piece->most_ticks, interval, most);
    if (add > 0 && most > 1) {
        uint32_t last = interval + (uint32_t)((uint32_t)add * (uint16_t)(most - 1));
        most = fit(piece->most_ticks, last, most);
    }
    piece->count = most;
    piece->interval = interval;
    piece->add = add;
}

void axis_move_position(int32_t *position, bool backward, uint32_t steps)
{
    if (backward) {
        steps = 0u - steps;
    }
    *position = (int32_t)((uint32_t)*position + steps);
}

bool axis_add_steps(int32_t *position, int32_t steps)
{
    int32_t from = *position;
    *position = (int32_t)((uint32_t)from + (uint32_t)steps);
    return steps < 0 ? *position < from : *position >= from;
}

void axis_give_steps(struct axis *axis, struct piece *piece)
{
    piece->kind = PIECE_STEPS;
    axis->interval = piece->interval;
    if (piece->add != 0) {
        axis->interval += (uint32_t)((int32_t)piece->add * (int32_t)(piece->count - 1));
    }
    axis_move_position(&axis->position, axis->backward, piece->count);
}
