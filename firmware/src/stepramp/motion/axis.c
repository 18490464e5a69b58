#include "stepramp/motion/axis.h"

#include "stepramp/motion/axis_by_formula.h"
#include "stepramp/motion/axis_steps.h"

/* A speed is held for a part of a piece at a time, while the ramp down is looked for. */
enum { HOLD_DIVISOR = 4 };

/* Segments of the ramp down that are looked at in one go: that takes less time than to come back for each. */
enum { SOUGHT_AT_ONCE = 4 };

/* The number of steps of a list. */
static uint32_t steps_of_list(const struct packed_list *list)
{
    struct ramp_cursor cursor;
    cursor_begin(&cursor, list);
    while (!cursor_is_at_end(&cursor)) {
        cursor_forward(&cursor, list, (uint16_t)(cursor.count - cursor.taken));
    }
    return cursor_steps(&cursor);
}

void axis_begin(struct axis *axis, const struct image_ramp *ramp)
{
    *axis = (struct axis){0};
    axis->level = ramp->slew_interval;
    axis->is_slewing = true;
    axis->is_by_formula = ramp->kind == RAMP_BY_FORMULA;
    if (axis_is_by_formula(axis)) {
        axis->constants = ramp->formula;
    } else {
        axis->up_list = ramp->up;
        axis->down_list = ramp->down;
        axis->down_steps = steps_of_list(&ramp->down);
    }
}

/* It comes to this interval [ticks]. */
static void reach(struct axis *axis, uint32_t interval)
{
    if (interval < axis->shortest) {
        axis->shortest = interval;
    }
}

/* ---- the ramp down ---- */

/* Goes on looking for the ramp down from the present speed, over one segment. Returns true when it is found. */
static bool ramp_down_is_found(struct axis *axis)
{
    return cursor_seek_forward(&axis->down, &axis->down_list, axis->shortest);
}

/* Holds the present speed for a part of a piece, at most `most` steps. Returns false when there are none. */
static bool hold(struct axis *axis, uint32_t most, struct piece *piece)
{
    if (axis->interval == 0 || most == 0) {
        return false;
    }
    axis_fit_steps(piece, axis->interval, 0, most);
    piece->count = piece->count > HOLD_DIVISOR ? piece->count / HOLD_DIVISOR : 1;
    axis_give_steps(axis, piece);
    return true;
}

/* Looks for the ramp down from the present speed. When it isn't found soon: gives nothing yet, or in a hurry some more
 * of the present speed, as long as there is room for that, and then looks on. Returns true when it is found. */
static bool find_ramp_down(struct axis *axis, struct piece *piece)
{
    uint8_t segments = SOUGHT_AT_ONCE;
    while (!ramp_down_is_found(axis)) {
        if (segments != 0) {
            segments--;
            continue;
        }
        uint32_t left = axis_steps_left(axis), steps_down = cursor_steps(&axis->down);
        if (!piece->in_a_hurry || hold(axis, left > steps_down ? left - steps_down : 0, piece)) {
            return false;
        }
    }
    return true;
}

/* Turns to the ramp down: so that it ends at the target, or, when that is too close, the shortest. Intervals that are
 * not longer than the present one may be part of it: they fill what is left between the last interval of the ramp up and
 * the next, which would be one too many. */
static void turn_down(struct axis *axis, struct piece *piece)
{
    if (!find_ramp_down(axis, piece)) {
        return;
    }
    uint32_t left = axis_steps_left(axis);
    while (cursor_steps(&axis->down) < left && !cursor_is_at_end(&axis->down)) {
        uint32_t missing = left - cursor_steps(&axis->down);
        uint16_t rest = (uint16_t)(axis->down.count - axis->down.taken);
        cursor_forward(&axis->down, &axis->down_list, missing < rest ? (uint16_t)missing : rest);
    }
    axis->phase = PHASE_DOWN;
}

/* ---- up ---- */

/* The shortest interval once `count` more intervals of the present segment of the ramp up have been played. */
static uint32_t shortest_after(const struct axis *axis, uint16_t count)
{
    const struct ramp_cursor *up = &axis->up;
    uint16_t index = up->add < 0 ? (uint16_t)(up->taken + count - 1) : up->taken;
    uint32_t interval = cursor_interval(up, index);
    return interval < axis->shortest ? interval : axis->shortest;
}

/* After `count` more steps up, whose ramp down begins in the present segment of `down`, it fits into what is then left of
 * `left` steps. */
static bool leaves_room(const struct axis *axis, const struct ramp_cursor *down, uint32_t left, uint16_t count)
{
    uint16_t most = (uint16_t)(down->count - down->taken);
    return cursor_steps(down) + cursor_count_longer(down, shortest_after(axis, count), most) <= left - count;
}

/* The same, the most steps up from `low`, of which it is known, to `high`. */
static uint16_t most_in_segment(const struct axis *axis, const struct ramp_cursor *down, uint32_t left, uint16_t low,
                                uint16_t high)
{
    uint16_t middle = high;
    while (low < high) {
        if (leaves_room(axis, down, left, middle)) {
            low = middle;
        } else {
            high = (uint16_t)(middle - 1);
        }
        middle = (uint16_t)(high - (high - low) / 2);
    }
    return low;
}

/* The most steps up, from `low` to `count`, whose ramp down begins in the present segment of `down`. */
static uint16_t most_that_stay(const struct axis *axis, const struct ramp_cursor *down, uint16_t low, uint16_t count)
{
    uint32_t to_pass = cursor_to_pass(down);
    if (cursor_is_at_end(down)) {
        return count;
    }
    uint16_t most = to_pass > axis->shortest ? 0 : cursor_count_longer(&axis->up, to_pass - 1, count);
    return most > low ? most : low;
}

/* After `count` more steps up the ramp down fits into what is then left of `left` steps. */
static bool all_leave_room(const struct axis *axis, uint32_t left, uint16_t count)
{
    struct ramp_cursor down = axis->down;
    uint32_t shortest = shortest_after(axis, count);
    while (cursor_steps(&down) <= left - count) {
        if (cursor_seek_forward(&down, &axis->down_list, shortest)) {
            return cursor_steps(&down) <= left - count;
        }
    }
    return false;
}

/* The most steps up, no more than `count`, that leave room for the ramp down: the more, the less room and the longer
 * the ramp down. Looked for a segment of the ramp down at a time, each of them once: there may be many. */
static uint16_t most_that_leave_room(const struct axis *axis, uint32_t left, uint16_t count)
{
    if (all_leave_room(axis, left, count)) { /* most often, and sooner known */
        return count;
    }
    struct ramp_cursor down = axis->down;
    uint16_t most = 0, high = 0;
    while (most == high && most < count && cursor_steps(&down) < left - most) {
        high = most_that_stay(axis, &down, most, count);
        most = most_in_segment(axis, &down, left, most, high);
        cursor_forward(&down, &axis->down_list, (uint16_t)(down.count - down.taken));
    }
    return most;
}

/* The next steps of the present segment of the ramp up that may be taken, if the ramp down allows it: those that are not
 * faster than commanded, and not past the target. */
static uint16_t steps_up(const struct axis *axis, uint32_t left)
{
    uint16_t count = (uint16_t)(axis->up.count - axis->up.taken);
    if (!axis->is_slewing) {
        count = cursor_count_longer(&axis->up, axis->level - 1, count);
    }
    return count < left ? count : (uint16_t)left;
}

static void go_up(struct axis *axis, struct piece *piece)
{
    uint32_t left = axis_steps_left(axis);
    if (left == 0) {
        turn_down(axis, piece);
        return;
    }
    uint16_t count = steps_up(axis, left);
    if (count == 0) {
        axis->phase = PHASE_LEVEL;
        return;
    }
    struct ramp_cursor *up = &axis->up;
    axis_fit_steps(piece, cursor_interval(up, up->taken), up->add, count);
    if (left - piece->count < axis->down_steps) {
        if (!find_ramp_down(axis, piece)) {
            return;
        }
        piece->count = most_that_leave_room(axis, left, piece->count);
    }
    if (piece->count == 0) {
        turn_down(axis, piece);
        return;
    }
    axis->shortest = shortest_after(axis, piece->count);
    axis_give_steps(axis, piece);
    cursor_forward(up, &axis->up_list, piece->count);
}

/* ---- level ---- */

static void go_level(struct axis *axis, struct piece *piece)
{
    uint32_t left = axis_steps_left(axis), steps_down = axis->down_steps;
    if (left <= steps_down || !axis->is_slewing || !cursor_is_at_end(&axis->up)) { /* else it is soon decided */
        if (left != 0 && steps_up(axis, left) != 0) {
            axis->phase = PHASE_UP;
            return;
        }
        if (left != 0 && !axis->is_slewing) {
            reach(axis, axis->level);
            if (!find_ramp_down(axis, piece)) {
                return;
            }
            if (axis_is_too_fast(axis)) {
                axis->phase = PHASE_DOWN;
                return;
            }
            steps_down = cursor_steps(&axis->down);
        }
        if (left <= steps_down) {
            turn_down(axis, piece);
            return;
        }
    }
    reach(axis, axis->level);
    axis_fit_steps(piece, axis->level, 0, left - steps_down);
    axis_give_steps(axis, piece);
}

/* ---- down ---- */

/* Goes on looking for the position on the ramp up that has this interval [ticks], over one segment. Returns true when it is
 * found. In PHASE_DOWN only: until that is left, `up` faces back. */
static bool ramp_up_is_found(struct axis *axis, uint32_t interval)
{
    return cursor_seek_back(&axis->up, interval);
}

/* Leaves the ramp down for a speed to go on with; what there is more of than the ramp down has is `room` [steps]. */
static void turn_up(struct axis *axis, uint32_t room, struct piece *piece)
{
    if (axis->interval == 0) { /* no step has been given yet: it sets out anew */
        axis->phase = PHASE_REST;
        return;
    }
    uint32_t interval = axis_is_too_fast(axis) ? axis->level : axis->interval;
    if (!ramp_up_is_found(axis, interval)) {
        if (piece->in_a_hurry) {
            hold(axis, room, piece);
        }
        return;
    }
    cursor_face_forward(&axis->up, &axis->up_list);
    cursor_face_forward(&axis->down, &axis->down_list);
    axis->interval = interval;
    axis->shortest = interval;
    axis->phase = PHASE_LEVEL;
}

static void go_down(struct axis *axis, struct piece *piece)
{
    struct ramp_cursor *down = &axis->down;
    cursor_face_back(down);
    uint32_t left = axis_steps_left(axis), steps_down = cursor_steps(down);
    uint16_t count = down->taken;
    if (left > steps_down) {
        count = axis_is_too_fast(axis) ? cursor_count_not_longer_back(down, axis->level) : 0;
        if (count == 0) {
            turn_up(axis, left - steps_down, piece);
            return;
        }
    }
    if (count == 0) {
        axis->phase = PHASE_REST;
        return;
    }
    uint32_t interval = cursor_interval(down, (uint16_t)(down->taken - 1));
    int16_t add = (int16_t)(0u - (uint16_t)down->add);
    axis_fit_steps(piece, interval, add, count);
    down->taken = (uint16_t)(down->taken - piece->count);
    axis_give_steps(axis, piece);
}

/* ---- all of it ---- */

static void go_on(struct axis *axis, struct piece *piece)
{
    switch (axis->phase) {
    case PHASE_UP:
        go_up(axis, piece);
        break;
    case PHASE_LEVEL:
        go_level(axis, piece);
        break;
    default:
        go_down(axis, piece);
    }
}

static inline bool sets_out_backward(const struct axis *axis)
{
    return axis->target < (axis_is_endless(axis) ? 0 : axis->position);
}

static void set_out(struct axis *axis)
{
    axis->backward = sets_out_backward(axis);
    axis->shortest = UINT32_MAX;
    if (axis_is_by_formula(axis)) {
        formula_rest(&axis->formula);
    } else {
        cursor_begin(&axis->up, &axis->up_list);
        cursor_begin(&axis->down, &axis->down_list);
    }
    axis->phase = PHASE_UP;
}

#if HAS_INPUTS
bool axis_goes_backward(const struct axis *axis)
{
    return axis->phase == PHASE_REST && !axis_is_at_rest(axis) ? sets_out_backward(axis) : axis->backward;
}

uint32_t axis_slowest(const struct axis *axis)
{
    if (axis_is_by_formula(axis)) {
        return formula_creep_interval(axis->constants);
    }
    struct ramp_cursor first;
    cursor_begin(&first, &axis->up_list);
    return first.count == 0 ? axis->level : first.first;
}
#endif

bool axis_is_at_rest(const struct axis *axis)
{
    return axis->phase == PHASE_REST && !axis_is_endless(axis) && axis->target == axis->position;
}

void axis_next(struct axis *axis, struct piece *piece)
{
    piece->kind = PIECE_NONE;
    if (axis->phase != PHASE_REST) {
        if (axis_is_by_formula(axis)) {
            axis_next_by_formula(axis, piece);
        } else {
            go_on(axis, piece);
        }
        return;
    }
    axis->interval = 0;
    if (axis_is_at_rest(axis)) {
        piece->kind = PIECE_REST;
    } else {
        axis->stopping = false;
        set_out(axis);
        piece->kind = PIECE_SET_OUT;
    }
}

bool axis_look_ahead(struct axis *axis)
{
    if (axis_is_by_formula(axis) || axis->phase == PHASE_REST) {
        return false;
    }
    if (axis->phase == PHASE_DOWN) {
        return !ramp_up_is_found(axis, axis->interval);
    }
    if (cursor_is_at_end(&axis->down)) {
        return false;
    }
    bool is_at_slew = axis->phase == PHASE_LEVEL && axis->is_slewing && axis->interval == axis->level;
    return !cursor_seek_forward(&axis->down, &axis->down_list, is_at_slew ? 0 : axis->shortest);
}

void axis_move_to(struct axis *axis, uint32_t slew_interval, int32_t target)
{
    axis->target = target;
    axis->level = slew_interval;
    axis->is_slewing = true;
    axis->stopping = false;
    axis->runs = false;
    axis->seeks_zero = false;
}

void axis_run(struct axis *axis, bool backward, uint32_t interval, bool is_slewing)
{
    axis_move_to(axis, interval, backward ? -1 : 1);
    axis->is_slewing = is_slewing;
    axis->runs = true;
    axis->ends = false;
}

#if HAS_INPUTS
void axis_end_run(struct axis *axis, int32_t end)
{
    axis->target = end;
    axis->ends = true;
}
#endif

/* Turns to the shortest ramp down, or, when no step has been given yet, is at rest again. */
static void turn_to_rest(struct axis *axis)
{
    if (axis->interval == 0) {
        axis->phase = PHASE_REST;
        axis->batch_left = 0;
    } else if (axis->phase == PHASE_UP || axis->phase == PHASE_LEVEL) {
        while (axis_look_ahead(axis)) {
        }
        axis->phase = PHASE_DOWN;
    }
}

static uint32_t steps_to_rest(const struct axis *axis)
{
    if (axis->phase == PHASE_REST) {
        return 0;
    }
    return axis_is_by_formula(axis) ? axis->batch_left + formula_steps_down(&axis->formula) : cursor_steps(&axis->down);
}

void axis_stop(struct axis *axis)
{
    axis->stopping = true;
    axis->runs = false;
    axis->seeks_zero = false;
    turn_to_rest(axis);
    axis->target = axis->position;
    axis_move_position(&axis->target, axis->backward, steps_to_rest(axis));
}

void axis_halt(struct axis *axis, int32_t position)
{
    axis->position = position;
    axis->target = position;
    axis->interval = 0;
    axis->stopping = false;
    axis->runs = false;
    axis->seeks_zero = false;
    axis->batch_left = 0;
    axis->phase = PHASE_REST;
}
