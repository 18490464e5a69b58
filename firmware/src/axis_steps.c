#include "axis_steps.h"

uint32_t steps_left(const struct axis *axis)
{
    if (axis->runs) {
        return axis->backward == (axis->target < 0) ? INT32_MAX : 0;
    }
    uint32_t distance = (uint32_t)axis->target - (uint32_t)axis->position;
    bool is_ahead = (axis->target > axis->position) != axis->backward;
    return !is_ahead ? 0 : axis->backward ? 0u - distance : distance;
}

bool is_too_fast(const struct axis *axis)
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

uint16_t steps_that_fit(const struct piece_limits *limits, uint32_t interval, int16_t add, uint16_t count)
{
    if (count > limits->steps) {
        count = limits->steps;
    }
    count = fit(limits->ticks, interval, count);
    if (add > 0 && count > 1) {
        uint32_t last = interval + (uint32_t)((uint32_t)add * (uint16_t)(count - 1));
        count = fit(limits->ticks, last, count);
    }
    return count;
}

void give_steps(struct axis *axis, struct piece given, struct piece *piece)
{
    axis->interval = given.interval;
    if (given.add != 0) {
        axis->interval += (uint32_t)((int32_t)given.add * (int32_t)(given.count - 1));
    }
    uint32_t steps = given.count;
    axis->position = (int32_t)((uint32_t)axis->position + (axis->backward ? 0u - steps : steps));
    *piece = given;
}
