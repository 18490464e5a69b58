#include "stepramp/motion/axis_by_formula.h"

#include "stepramp/motion/axis_steps.h"

/* Of its phase, before steps are computed again: from slowing down to a speed that is held, or to rising, and back. */
enum { MOST_CHANGES = 3 };

/* How many intervals are computed at a time, after one of so many ticks: more is faster, but 16 bits must hold their
 * differences, and a stop waits for them. On the ramp down the next one is at most 1.75 times as long, as x^2 is below
 * 3/4. */
static uint8_t batch_size(uint32_t interval, bool goes_up)
{
    if (interval == 0 || interval > 20000) {
        return 1;
    }
    return goes_up || interval <= 2000 ? FORMULA_BATCH : interval <= 8000 ? 4 : interval <= 14000 ? 3 : 2;
}

/* ---- giving what has been computed ---- */

/* Those of the batch that are evenly apart go as one piece: at high speeds most of them. */
static void give_from_batch(struct axis *axis, struct piece *piece)
{
    const int16_t *adds = axis->adds + (axis->batch_size - axis->batch_left);
    uint8_t count = 1;
    while (count < axis->batch_left && adds[count - 1] == adds[0]) {
        count++;
    }
    axis_fit_steps(piece, axis->next, count > 1 ? adds[0] : 0, count);
    axis_give_steps(axis, piece);
    count = (uint8_t)piece->count;
    axis->batch_left = (uint8_t)(axis->batch_left - count);
    if (axis->batch_left != 0) {
        axis->next = axis->interval + (uint32_t)(int32_t)adds[count - 1];
    }
}

static void go_level(struct axis *axis, uint32_t left, struct piece *piece)
{
    uint32_t steps_down = formula_steps_down(&axis->formula);
    bool may_rise = axis->is_slewing || axis->interval > axis->level;
    if (left <= steps_down || axis_is_too_fast(axis)) {
        axis->phase = PHASE_DOWN;
    } else if (may_rise && !formula_slews(&axis->formula)) {
        axis->phase = PHASE_UP;
    } else {
        axis_fit_steps(piece, axis->level, 0, left - steps_down);
        axis_give_steps(axis, piece);
    }
}

void axis_next_by_formula(struct axis *axis, struct piece *piece)
{
    if (axis->batch_left != 0) {
        give_from_batch(axis, piece);
    } else if (axis->phase == PHASE_LEVEL) {
        go_level(axis, axis_steps_left(axis), piece);
    }
}

/* ---- computing ---- */

static void keep_batch(struct axis *axis, const uint32_t *intervals, uint8_t size)
{
    axis->next = intervals[0];
    axis->batch_size = size;
    axis->batch_left = size;
    for (uint8_t i = 1; i < size; i++) {
        axis->adds[i - 1] = (int16_t)(uint16_t)(intervals[i] - intervals[i - 1]);
    }
}

/* A batch of steps at one speed, at most `left` of them. */
static void keep_level(struct axis *axis, uint32_t interval, uint32_t left)
{
    uint8_t most = batch_size(interval, true);
    axis->next = interval;
    axis->batch_size = left < most ? (uint8_t)left : most;
    axis->batch_left = axis->batch_size;
    for (uint8_t i = 0; i < FORMULA_BATCH - 1; i++) {
        axis->adds[i] = 0;
    }
}

/* Of falling or rising intervals those before the first that is beyond the commanded speed: shorter on the ramp up; on the
 * ramp down, where that one is the last, longer. At speed it takes too long to compute them one by one. */
static uint8_t count_to_level(const struct axis *axis, const uint32_t *intervals, uint8_t size, bool goes_up)
{
    uint8_t count = 0;
    while (count < size && (goes_up ? intervals[count] >= axis->level : intervals[count] < axis->level)) {
        count++;
    }
    return goes_up || count == size ? count : (uint8_t)(count + 1);
}

/* Computes a batch along the ramp up or down: up to the commanded speed, when it is to be `limited` by that. Returns false
 * when the ramp allows none; when only the speed doesn't, it is at that. */
static bool compute_batch(struct axis *axis, uint32_t left, bool goes_up, bool limited)
{
    struct formula_state before = axis->formula;
    uint32_t intervals[FORMULA_BATCH];
    uint8_t most = batch_size(axis->interval, goes_up), size;
    for (;;) {
        size = goes_up ? formula_up(&axis->formula, axis->constants, intervals, most, left)
                       : formula_down(&axis->formula, axis->constants, intervals, most);
        uint8_t count = limited ? count_to_level(axis, intervals, size, goes_up) : size;
        if (count == size) {
            break;
        }
        axis->formula = before;
        most = count;
        if (most == 0) {
            return true;
        }
    }
    if (size != 0) {
        keep_batch(axis, intervals, size);
    }
    return size != 0;
}

/* Goes up, as long as that isn't faster than commanded and there is room: or else stays at this speed, or turns. */
static void compute_up(struct axis *axis, uint32_t left)
{
    uint32_t steps_down = formula_steps_down(&axis->formula);
    if (formula_slews(&axis->formula)) {
        axis->phase = PHASE_LEVEL;
    } else if (steps_down != 0 && axis_is_too_fast(axis)) {
        axis->phase = PHASE_DOWN;
    } else if (compute_batch(axis, left, true, !axis->is_slewing)) {
        if (axis->batch_left == 0) {
            axis->phase = PHASE_LEVEL;
            keep_level(axis, axis->level, left - steps_down);
        }
    } else if (left <= steps_down) {
        axis->phase = PHASE_DOWN;
    } else {
        keep_level(axis,
                   steps_down == 0 ? formula_creep_interval(axis->constants) : formula_hold_interval(&axis->formula),
                   left - steps_down);
    }
}

static void compute_down(struct axis *axis, uint32_t left)
{
    uint32_t steps_down = formula_steps_down(&axis->formula);
    bool goes_on = left > steps_down;
    if (steps_down == 0 && !goes_on) {
        axis->phase = PHASE_REST;
    } else if (goes_on && (!axis_is_too_fast(axis) || steps_down == 0)) {
        axis->phase = PHASE_UP;
    } else {
        compute_batch(axis, left, false, goes_on);
    }
}

static void compute(struct axis *axis)
{
    uint32_t left = axis_steps_left(axis);
    if (axis->phase == PHASE_UP) {
        if (left == 0) {
            axis->phase = PHASE_DOWN;
        } else {
            compute_up(axis, left);
        }
    } else if (axis->phase == PHASE_DOWN) {
        compute_down(axis, left);
    }
}

/* A change of its phase gives no steps, but then the next round of the main loop may come too late. */
void axis_compute(struct axis *axis)
{
    if (!axis_is_by_formula(axis)) {
        return;
    }
    for (uint8_t changes = MOST_CHANGES; changes != 0 && axis->batch_left == 0; changes--) {
        compute(axis);
    }
}
