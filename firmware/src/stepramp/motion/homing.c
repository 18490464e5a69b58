#include "stepramp/motion/homing.h"

#if HAS_INPUTS

#include "stepramp/edge/board_limits.h"
#include "stepramp/edge/out_of_line.h"
#include "stepramp/motion/machine.h"
#include "stepramp/motion/machine_axes.h"
#include "stepramp/motion/machine_inputs.h"
#include "stepramp/store/ramp_image.h"

enum stage {
    NOT_HOMING,
    APPROACHING, /* fast, until the switch has stopped it */
    BACKING_OFF, /* slowly, until the switch is inactive */
    CLEARING,    /* by some steps more */
    RETURNING    /* slowly, until the switch is seen */
};

static uint8_t stages[MOST_AXES];
static bool is_any; /* axis may be homed */
static int32_t clear_at[MOST_AXES]; /* [steps] where the switch was inactive last, while it returns */
static uint8_t backward;            /* the way to the switch, a bit for each axis */
static uint32_t slow;               /* [ticks] */
static uint16_t back_off;           /* [steps] */

uint8_t homing_axes(void)
{
    uint8_t axes = 0;
    if (!is_any) {
        return 0;
    }
    for (uint8_t axis = MOST_AXES; axis-- > 0;) {
        axes = (uint8_t)(axes << 1 | (stages[axis] != NOT_HOMING));
    }
    return axes;
}

void homing_end(uint8_t axes)
{
    for (uint8_t axis = 0; axis < MOST_AXES; axis++, axes >>= 1) {
        if ((axes & 1) != 0) {
            stages[axis] = NOT_HOMING;
        }
    }
}

static bool is_backward(uint8_t axis)
{
    return (backward >> axis & 1) != 0;
}

static bool is_at_switch(uint8_t axis)
{
    return machine_limit_at(axis, is_backward(axis)) != NO_INPUT;
}

static int32_t interval_towards(bool goes_backward)
{
    return goes_backward ? -(int32_t)slow : (int32_t)slow;
}

uint8_t homing_begin(uint8_t axes, int32_t *intervals, uint32_t slow_interval, uint16_t steps_back,
                     uint16_t *detail)
{
    int32_t *interval = intervals;
    uint8_t ways = 0;
    for (uint8_t axis = 0; axis < MOST_AXES; axis++) {
        if ((axes >> axis & 1) == 0) {
            continue;
        }
        bool goes_backward = *interval < 0;
        bool is_known = axis < stepramp_axis_count && machine_has_limit(axis, goes_backward);
        if (!is_known || *interval == 0 || slow_interval < ramp_image_slew_interval(stepramp_image, axis) ||
            slow_interval > LONGEST_INTERVAL_TICKS) {
            *detail = axis;
            return STATUS_OUT_OF_RANGE;
        }
        ways |= (uint8_t)(goes_backward << axis);
        if (machine_limit_at(axis, goes_backward) != NO_INPUT) { /* it is there already */
            *interval = goes_backward ? (int32_t)slow_interval : -(int32_t)slow_interval;
        }
        interval++;
    }
    uint8_t known = stepramp_known_positions;
    stepramp_known_positions &= (uint8_t)~axes; /* soft limits don't hold meanwhile */
    uint8_t status = machine_run(axes, intervals, detail);
    if (status != STATUS_OK) {
        stepramp_known_positions = known;
        return status;
    }
    slow = slow_interval;
    back_off = steps_back;
    backward = ways;
    is_any = true;
    for (uint8_t axis = 0; axis < MOST_AXES; axis++) {
        if ((axes >> axis & 1) != 0) {
            stages[axis] = is_at_switch(axis) ? BACKING_OFF : APPROACHING;
        }
    }
    return STATUS_OK;
}

/* What follows has frames of its own: those of what isn't done at the time would take room on the stack that there is not. */

/* Runs it slowly. Returns false when that can't be. */
static OUT_OF_LINE bool run(uint8_t axis, bool goes_backward)
{
    uint16_t detail;
    int32_t interval = interval_towards(goes_backward);
    return machine_run((uint8_t)(1u << axis), &interval, &detail) == STATUS_OK;
}

/* On from where it is, away from the switch. Returns false when that can't be. */
static OUT_OF_LINE bool clear(uint8_t axis)
{
    uint16_t detail;
    int32_t target = machine_report(axis).position;
    axis_move_position(&target, !is_backward(axis), back_off);
    return machine_move_to((uint8_t)(1u << axis), &target, &detail) == STATUS_OK;
}

/* It has seen its switch: halted slowly, where it loses no step. */
static OUT_OF_LINE void finish(uint8_t axis)
{
    uint8_t bit = (uint8_t)(1u << axis);
    machine_halt(bit);
    int32_t position = machine_report(axis).position;
    position = (int32_t)((uint32_t)position - (uint32_t)clear_at[axis]);
    machine_set_position(bit, &position);
    stages[axis] = NOT_HOMING;
}

/* Returns the stage that it is in then. */
static uint8_t next_stage(uint8_t axis)
{
    bool is_moving = machine_axis_is_moving(axis);
    switch (stages[axis]) {
    case APPROACHING:
        if (is_moving) {
            return APPROACHING;
        }
        return is_at_switch(axis) && run(axis, !is_backward(axis)) ? BACKING_OFF : NOT_HOMING;
    case BACKING_OFF:
        if (is_moving && is_at_switch(axis)) {
            return BACKING_OFF;
        }
        return is_moving && clear(axis) ? CLEARING : NOT_HOMING;
    case CLEARING:
        if (is_moving) {
            return CLEARING;
        }
        clear_at[axis] = machine_report(axis).position;
        return run(axis, is_backward(axis)) ? RETURNING : NOT_HOMING;
    default:
        return is_moving ? RETURNING : NOT_HOMING;
    }
}

static OUT_OF_LINE void return_to(uint8_t axis)
{
    if (is_at_switch(axis)) {
        finish(axis);
    } else if (!machine_sees_limit(axis, is_backward(axis))) {
        clear_at[axis] = machine_report(axis).position;
    }
}

void homing_go_on(void)
{
    if (!is_any) {
        return;
    }
    is_any = homing_axes() != 0;
    for (uint8_t axis = 0; axis < MOST_AXES; axis++) {
        if (stages[axis] == RETURNING) {
            return_to(axis);
        }
        if (stages[axis] != NOT_HOMING) {
            stages[axis] = next_stage(axis);
        }
    }
}

#endif
