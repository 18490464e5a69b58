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

/* A switch that stays as it is isn't looked for for ever: slowly an axis goes as far as on the way before, and so many times the
 * steps to back off. */
enum { MOST_BACK_OFFS = 64 };

static struct homing {
    union {
        uint32_t slow; /* [ticks] as long as it approaches: later it is the axis' level */
        uint32_t most; /* [steps] of the way that it is on then */
    };
    union {
        uint16_t back_off; /* [steps] until it returns */
        uint16_t clear_at; /* [steps] while it does: where the switch was inactive last, its low bits */
    };
    uint8_t stage : 4;
    bool backward : 1; /* the way to the switch */
} homings[MOST_AXES]; /* of those that are not in stepramp_homing_axes it doesn't count */

void homing_end(uint8_t axes)
{
    stepramp_homing_axes &= (uint8_t)~axes;
}

static bool is_at_switch(uint8_t axis, const struct homing *homing)
{
    return machine_limit_at(axis, homing->backward) != NO_INPUT;
}

static int32_t interval_towards(bool goes_backward, uint32_t interval)
{
    return goes_backward ? -(int32_t)interval : (int32_t)interval;
}

/* Prepares an axis at rest, and its interval. Returns false when it can't be homed so. */
static inline bool prepare(uint8_t axis, int32_t *interval, uint32_t slow_interval, uint16_t steps_back)
{
    bool goes_backward = *interval < 0;
    bool is_known = axis < stepramp_axis_count && machine_has_limit(axis, goes_backward);
    if (!is_known || *interval == 0 || steps_back == 0 || slow_interval < ramp_image_slew_interval(stepramp_image, axis) ||
        slow_interval > LONGEST_INTERVAL_TICKS) {
        return false;
    }
    struct homing *homing = &homings[axis];
    homing->backward = goes_backward;
    homing->back_off = steps_back;
    homing->slow = slow_interval;
    homing->stage = APPROACHING;
    if (is_at_switch(axis, homing)) {
        *interval = interval_towards(!goes_backward, slow_interval);
        homing->most = (uint32_t)steps_back * MOST_BACK_OFFS;
        homing->stage = BACKING_OFF;
    }
    return true;
}

uint8_t homing_begin(uint8_t axes, int32_t *intervals, uint32_t slow_interval, uint16_t steps_back,
                     uint16_t *detail)
{
    int32_t *interval = intervals;
    for (uint8_t axis = 0; axis < MOST_AXES; axis++) {
        if ((axes >> axis & 1) != 0 && !prepare(axis, interval++, slow_interval, steps_back)) {
            *detail = axis;
            return STATUS_OUT_OF_RANGE;
        }
    }
    stepramp_homing_axes |= axes;
    uint8_t known = stepramp_known_positions;
    stepramp_known_positions &= (uint8_t)~axes; /* soft limits don't hold meanwhile */
    uint8_t status = machine_run(axes, intervals, detail);
    if (status != STATUS_OK) {
        homing_end(axes);
        stepramp_known_positions = known;
    }
    return status;
}

/* What follows has frames of its own: those of what isn't done at the time would take room on the stack that there is not. */

/* Runs it slowly the way that it came. Returns false when that can't be. */
static OUT_OF_LINE bool run(const struct feed *feed, struct homing *homing, bool goes_backward, uint32_t slow)
{
    uint16_t detail;
    int32_t interval = interval_towards(goes_backward, slow);
    homing->most = (uint32_t)homing->back_off * MOST_BACK_OFFS + feed->played.steps_made;
    return machine_run(feed->bit, &interval, &detail) == STATUS_OK;
}

/* It has seen its switch: halted slowly, where it loses no step. */
static OUT_OF_LINE void finish(const struct feed *feed, struct homing *homing)
{
    machine_halt(feed->bit);
    int32_t position = (int16_t)((uint16_t)feed->played.position - homing->clear_at);
    machine_set_position(feed->bit, &position);
    homing->stage = NOT_HOMING;
}

/* Returns the stage that it is in then. */
static uint8_t next_stage(const struct feed *feed, struct homing *homing)
{
    uint8_t stage = homing->stage;
    if (feed_is_moving(feed)) {
        if (stage == BACKING_OFF && !is_at_switch(feed->index, homing)) {
            homing->most = feed->played.steps_made + homing->back_off;
            return CLEARING;
        }
        if (stage != APPROACHING && feed->played.steps_made >= homing->most) {
            machine_stop(feed->bit);
        }
        return stage;
    }
    if (stage == APPROACHING && is_at_switch(feed->index, homing)) {
        return run(feed, homing, !homing->backward, homing->slow) ? BACKING_OFF : NOT_HOMING;
    }
    if (stage == CLEARING) {
        stage = run(feed, homing, homing->backward, feed->axis.level) ? RETURNING : NOT_HOMING;
        homing->clear_at = (uint16_t)feed->played.position;
        return stage;
    }
    return NOT_HOMING;
}

static OUT_OF_LINE void return_to(const struct feed *feed, struct homing *homing)
{
    if (is_at_switch(feed->index, homing)) {
        finish(feed, homing);
    } else if (!machine_sees_limit(feed->index, homing->backward)) {
        homing->clear_at = (uint16_t)machine_position(feed->index);
    }
}

void homing_go_on(void)
{
    const struct feed *feed = stepramp_feeds;
    for (struct homing *homing = homings; homing < homings + MOST_AXES; homing++, feed++) {
        if ((stepramp_homing_axes & feed->bit) == 0) {
            continue;
        }
        if (homing->stage == RETURNING) {
            return_to(feed, homing);
        }
        if (homing->stage != NOT_HOMING) {
            homing->stage = next_stage(feed, homing);
        }
        if (homing->stage == NOT_HOMING) {
            homing_end(feed->bit);
        }
    }
}

#endif
