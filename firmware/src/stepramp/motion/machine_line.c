/* Along a straight line. */
#include "stepramp/motion/machine.h"

#include "stepramp/edge/board_limits.h"
#include "stepramp/edge/line.h"
#include "stepramp/edge/out_of_line.h"
#include "stepramp/motion/feed.h"
#include "stepramp/motion/machine_axes.h"
#include "stepramp/motion/machine_inputs.h"
#include "stepramp/motion/share.h"
#include "stepramp/store/ramp_image.h"

/* The axes that are asked to make a straight line. */
struct line_plan {
    uint32_t lengths[MOST_AXES]; /* [steps] */
    uint8_t count;               /* of those that make steps */
    uint8_t backward;            /* a bit each */
    struct feed *leader;         /* with most steps */
    uint32_t longest;            /* [steps] of the leader */
};

/* Plans a line. Returns the index of an axis that would leave the range, or MOST_AXES. */
static uint8_t plan_line(struct line_plan *plan, uint8_t mask, const int32_t *steps)
{
    *plan = (struct line_plan){.leader = stepramp_feeds};
    uint32_t *length = plan->lengths;
    for (struct feed *feed = stepramp_feeds; mask != 0; feed++, mask >>= 1, length++) {
        if ((mask & 1) == 0) {
            continue;
        }
        int32_t by = *steps++, target = feed->played.position;
        if (by == 0) {
            continue;
        }
        if (!axis_add_steps(&target, by)) {
            return feed->index;
        }
        *length = machine_without_sign(by);
        plan->count++;
        if (by < 0) {
            plan->backward |= feed->bit;
        }
        if (*length > plan->longest) {
            plan->longest = *length;
            plan->leader = feed;
        }
    }
    return MOST_AXES;
}

/* Lays out a line for its leader, with this ramp. */
static void begin_line(const struct line_plan *plan, const struct image_ramp *ramp)
{
    struct feed *leader = plan->leader;
    const uint32_t *length = plan->lengths;
    struct feed *feed = stepramp_feeds;
    for (uint8_t left = stepramp_axis_count; left != 0; left--, feed++) {
        bool backward = (plan->backward & feed->bit) != 0;
        if (*length++ != 0 && feed != leader && feed->pin_backward != backward) {
            feed->pin_backward = backward;
            leader->turns_too |= feed->bit;
        }
    }
    int32_t target = leader->played.position;
    line_begin(leader->index, plan->lengths);
    axis_begin(&leader->axis, ramp);
    axis_halt(&leader->axis, target);
    axis_move_position(&target, (plan->backward & leader->bit) != 0, plan->longest);
    axis_move_to(&leader->axis, ramp->slew_interval, target);
    feed_set_out(leader);
}

uint8_t machine_line(uint8_t mask, uint8_t ramp_axis, const int32_t *steps, uint16_t *detail)
{
    struct line_plan plan;
    uint8_t status = machine_check_mask(mask, detail);
    if (status != STATUS_OK) {
        return status;
    }
    if (ramp_axis >= stepramp_axis_count || stepramp_machine_settings->outputs == OUTPUTS_GAUGES) {
        *detail = ramp_axis;
        return STATUS_OUT_OF_RANGE;
    }
    *detail = plan_line(&plan, mask, steps);
    if (*detail != MOST_AXES) {
        return STATUS_OUT_OF_RANGE;
    }
#if HAS_INPUTS
    for (uint8_t axis = 0; has_inputs() && axis < MOST_AXES; axis++) {
        if (plan.lengths[axis] != 0) {
            status = WITH_INPUTS(machine_check_part)(axis, (plan.backward >> axis & 1) != 0, plan.lengths[axis], detail);
            if (status != STATUS_OK) {
                return status;
            }
        }
    }
#endif
    if (plan.count != 0) {
        struct image_ramp ramp = ramp_image_ramp(stepramp_image, ramp_axis);
        status = share_check_line(ramp.slew_interval, plan.count, detail);
        if (status == STATUS_OK) {
            begin_line(&plan, &ramp);
        }
    }
    return status;
}

/* The line has come to rest: its axes are axes of their own again. Only the leader's had another's ramp. */
void machine_end_line(void)
{
    struct feed *feed = stepramp_feeds;
    for (uint8_t left = stepramp_axis_count; left != 0; left--, feed++) {
        axis_move_position(&feed->played.position, feed->pin_backward, line_steps_made(feed->index));
        axis_halt(&feed->axis, feed->played.position);
    }
    line_end();
    machine_make_pins_ready();
    machine_begin_axis(machine_leader());
}
