/* What its axes do, and how far they have come. */
#include "stepramp/motion/machine.h"

#include "stepramp/edge/line.h"
#include "stepramp/edge/out_of_line.h"
#include "stepramp/motion/feed.h"
#include "stepramp/motion/machine_axes.h"

/* The steps that the leader of a line will have made when it comes to rest: its target lies ahead all along. */
static OUT_OF_LINE uint32_t steps_of_leader(void)
{
    const struct feed *leader = machine_leader();
    uint32_t distance = (uint32_t)leader->axis.target - (uint32_t)leader->played.position;
    return leader->played.steps_made + machine_without_sign((int32_t)distance);
}

struct axis_report machine_report(uint8_t index)
{
    const struct feed *feed = &stepramp_feeds[index];
    bool follows = line_follows(index);
    const struct feed *leader = follows ? machine_leader() : feed;
    struct feed_progress progress;
    feed_progress(leader, &progress);
    struct axis_report report = {AXIS_IDLE, progress.position, progress.steps_made};
    if (follows || feed_is_moving(feed)) {
        report.state = leader->axis.stopping ? AXIS_STOPPING : AXIS_MOVING;
    }
    if (follows) {
        report.steps_made = line_steps_made(index);
        report.position = feed->played.position;
        axis_move_position(&report.position, feed->pin_backward, report.steps_made);
    }
    return report;
}

OUT_OF_LINE uint32_t machine_interval(uint8_t index)
{
    const struct feed *feed = &stepramp_feeds[index];
    return feed_is_moving(feed) ? feed_interval(feed) : 0;
}

bool machine_axis_is_moving(uint8_t index)
{
    return line_follows(index) || feed_is_moving(&stepramp_feeds[index]);
}

bool machine_runs(uint8_t index)
{
    return stepramp_feeds[index].axis.runs;
}

int32_t machine_position(uint8_t index)
{
    struct feed_progress progress;
    feed_progress(&stepramp_feeds[index], &progress);
    return progress.position;
}

int32_t machine_target(uint8_t index)
{
    const struct feed *feed = &stepramp_feeds[index];
    if (line_follows(index)) {
        int32_t target = feed->played.position;
        axis_move_position(&target, feed->pin_backward, line_steps_with(index, steps_of_leader()));
        return target;
    }
    if (feed_is_moving(feed) && !feed->axis.runs) {
        return feed->axis.target;
    }
    return machine_position(index);
}
