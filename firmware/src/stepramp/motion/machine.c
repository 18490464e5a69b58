#include "stepramp/motion/machine.h"

#include <stddef.h>

#include "stepramp/edge/board.h"
#include "stepramp/edge/board_limits.h"
#include "stepramp/edge/engine.h"
#include "stepramp/edge/out_of_line.h"
#include "stepramp/motion/feed.h"
#include "stepramp/motion/line.h"
#include "stepramp/motion/share.h"
#include "stepramp/store/ramp_image.h"

/* From the start of a queue to its first segment [us]: time to queue some more. */
#ifndef START_US
#define START_US 200
#endif

enum { MOST_GAUGES = 3 };

enum { ALL_AXES = (1 << MOST_AXES) - 1 };

/* What a step takes of the processor without its pulse, and when a segment begins with it [us]. */
enum { STEP_US = 10 };

/* So often moves make way for what has been received, until the line has been silent: enough for a request. */
enum { MOST_YIELDS = 4 };

static const uint8_t *image;
const struct settings *stepramp_machine_settings;
static struct feed feeds[MOST_AXES];
static uint8_t axis_count; /* of the image */
static uint8_t next_axis;  /* whose turn it is */
static bool is_short;      /* of what is queued for one of the axes before it */
static bool is_enabled;
static uint16_t polled_ms;      /* when the main loop came round last */
static uint16_t enabled_for_ms; /* for so long the motors have been enabled, */
static uint16_t at_rest_for_ms; /* and at rest. 65535 stays 65535, however long that is */
static uint8_t yields; /* so often what has been received may still come first, before all axes have had their turn */

static uint8_t ticks_a_us(void)
{
    return stepramp_feed_clock.is_fast ? FAST_CLOCK_HZ / 1000000u : SLOW_CLOCK_HZ / 1000000u;
}

/* [ticks] */
static OUT_OF_LINE uint32_t slew_interval_of(const struct feed *feed)
{
    return ramp_image_slew_interval(image, feed->index);
}

/* Does something with each axis of a mask. */
static void for_each(uint8_t mask, void (*act)(struct feed *feed))
{
    for (struct feed *feed = feeds; mask != 0; feed++, mask >>= 1) {
        if ((mask & 1) != 0) {
            act(feed);
        }
    }
}

/* ---- requests ---- */

static uint8_t check_mask(uint8_t mask, uint16_t *detail)
{
    if (image == NULL) {
        *detail = 0;
        return STATUS_NO_RAMP;
    }
    *detail = mask;
    bool is_known = mask != 0 && mask >> axis_count == 0;
    bool has_pins = stepramp_machine_settings->outputs != OUTPUTS_GAUGES || mask >> MOST_GAUGES == 0;
    return is_known && has_pins ? STATUS_OK : STATUS_OUT_OF_RANGE;
}

static OUT_OF_LINE uint32_t without_sign(int32_t number)
{
    return number < 0 ? 0u - (uint32_t)number : (uint32_t)number;
}

/* The interval that is requested of an axis of the mask [ticks]; 0: a run at no speed, which is a stop. */
static uint32_t requested_interval(const struct feed *feed, int32_t value, bool is_run)
{
    return is_run ? without_sign(value) : slew_interval_of(feed);
}

/* With its ramp; what has not set out yet doesn't. */
static void stop(struct feed *feed)
{
    if (feed_has_stepped(feed)) {
        axis_stop(&feed->axis);
    } else {
        machine_halt(feed->bit);
    }
}

static void begin_order(struct feed *feed, uint32_t interval, int32_t value, bool is_run)
{
    if (interval == 0) {
        stop(feed);
        return;
    }
    if (is_run) {
        axis_run(&feed->axis, value < 0, interval, interval == slew_interval_of(feed));
    } else {
        axis_move_to(&feed->axis, interval, value);
    }
    feed_set_out(feed);
}

/* Moves the axes of the mask to positions, or runs them at intervals with a sign. */
static uint8_t order(uint8_t mask, const int32_t values[MOST_AXES], bool is_run, uint16_t *detail)
{
    uint32_t requested[MOST_AXES] = {0};
    uint8_t status = check_mask(mask, detail);
    if (status != STATUS_OK) {
        return status;
    }
    const int32_t *value = values;
    uint32_t *interval_of = requested;
    struct feed *feed = feeds;
    for (uint8_t left = axis_count; left != 0; left--, feed++, value++) {
        uint32_t interval = (mask & feed->bit) != 0 ? requested_interval(feed, *value, is_run) : 0;
        *interval_of++ = interval;
        if (interval != 0 && (interval < slew_interval_of(feed) || interval > LONGEST_INTERVAL_TICKS)) {
            *detail = feed->index;
            return STATUS_OUT_OF_RANGE;
        }
    }
    status = share_check(feeds, axis_count, requested, detail);
    if (status != STATUS_OK) {
        return status;
    }
    interval_of = requested;
    for (struct feed *feed = feeds; mask != 0; feed++, mask >>= 1, interval_of++, values++) {
        if ((mask & 1) != 0) {
            begin_order(feed, *interval_of, *values, is_run);
        }
    }
    return STATUS_OK;
}

uint8_t machine_move_to(uint8_t mask, const int32_t targets[MOST_AXES], uint16_t *detail)
{
    return order(mask, targets, false, detail);
}

uint8_t machine_run(uint8_t mask, const int32_t intervals[MOST_AXES], uint16_t *detail)
{
    return order(mask, intervals, true, detail);
}

void machine_set_position(uint8_t mask, const int32_t positions[MOST_AXES])
{
    for (struct feed *feed = feeds; mask != 0; feed++, mask >>= 1, positions++) {
        if ((mask & 1) != 0) {
            feed->played.position = *positions;
            axis_halt(&feed->axis, *positions);
        }
    }
}

uint8_t machine_zero(uint8_t mask, uint16_t steps, uint16_t *detail)
{
    const int32_t zeros[MOST_AXES] = {0};
    uint8_t status = machine_move_to(mask, zeros, detail);
    for (struct feed *feed = feeds; status == STATUS_OK && mask != 0; feed++, mask >>= 1) {
        if ((mask & 1) != 0) {
            feed->played.position = steps;
            feed->axis.position = steps; /* it has not set out yet */
        }
    }
    return status;
}

/* ---- lines ---- */

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
    *plan = (struct line_plan){.leader = feeds};
    uint32_t *length = plan->lengths;
    for (struct feed *feed = feeds; mask != 0; feed++, mask >>= 1, steps++, length++) {
        if ((mask & 1) == 0 || *steps == 0) {
            continue;
        }
        int32_t target = feed->played.position;
        if (!axis_add_steps(&target, *steps)) {
            return feed->index;
        }
        *length = without_sign(*steps);
        plan->count++;
        if (*steps < 0) {
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
    struct feed *feed = feeds;
    for (uint8_t left = axis_count; left != 0; left--, feed++) {
        bool backward = (plan->backward & feed->bit) != 0;
        if (*length++ != 0 && feed != leader && feed->pin_backward != backward) {
            feed->pin_backward = backward;
            leader->turns_too |= feed->bit;
        }
    }
    int32_t target = leader->played.position;
    engine_set_line(true);
    line_begin(leader->index, plan->lengths);
    axis_begin(&leader->axis, ramp);
    axis_halt(&leader->axis, target);
    axis_move_position(&target, (plan->backward & leader->bit) != 0, plan->longest);
    axis_move_to(&leader->axis, ramp->slew_interval, target);
    feed_set_out(leader);
}

uint8_t machine_line(uint8_t mask, uint8_t ramp_axis, const int32_t steps[MOST_AXES], uint16_t *detail)
{
    struct line_plan plan;
    uint8_t status = check_mask(mask, detail);
    if (status != STATUS_OK) {
        return status;
    }
    if (ramp_axis >= axis_count || stepramp_machine_settings->outputs == OUTPUTS_GAUGES) {
        *detail = ramp_axis;
        return STATUS_OUT_OF_RANGE;
    }
    *detail = plan_line(&plan, mask, steps);
    if (*detail != MOST_AXES) {
        return STATUS_OUT_OF_RANGE;
    }
    if (plan.count != 0) {
        struct image_ramp ramp = ramp_image_ramp(image, ramp_axis);
        status = share_check_line(ramp.slew_interval, plan.count, detail);
        if (status == STATUS_OK) {
            begin_line(&plan, &ramp);
        }
    }
    return status;
}

static void point_forward(struct feed *feed)
{
    feed->pin_backward = false;
    feed->played.backward = false;
    feed->turns_too = 0;
}

/* At rest: all directions forward, whatever was queued of turns. */
static void make_pins_ready(void)
{
    engine_configure(stepramp_machine_settings);
    for_each(ALL_AXES, point_forward);
}

/* Begins with an axis at rest where it is, with its own ramp. */
static void begin_axis(struct feed *feed)
{
    struct image_ramp ramp = ramp_image_ramp(image, feed->index);
    axis_begin(&feed->axis, &ramp);
    axis_halt(&feed->axis, feed->played.position);
}

/* The index of an axis among the followers of a line; MOST_FOLLOWERS: it is none. */
static uint8_t follower_index(const struct feed *feed)
{
    const struct follower *follower = stepramp_line.followers;
    for (uint8_t k = 0; line_is_on() && k < stepramp_line.follower_count; k++, follower++) {
        if (follower->axis == feed->index) {
            return k;
        }
    }
    return MOST_FOLLOWERS;
}

/* The steps of an axis that follows in a line, as far as that has been played. */
static uint32_t follower_steps(const struct feed *feed, const struct line_progress *progress)
{
    uint8_t follower = follower_index(feed);
    return follower == MOST_FOLLOWERS ? 0 : line_steps_of(progress, follower);
}

/* The line has come to rest: its axes are axes of their own again. Only the leader's had another's ramp. */
static void end_line(const struct line_progress *progress)
{
    struct feed *feed = feeds;
    for (uint8_t left = axis_count; left != 0; left--, feed++) {
        axis_move_position(&feed->played.position, feed->pin_backward, follower_steps(feed, progress));
        axis_halt(&feed->axis, feed->played.position);
    }
    stepramp_line.is_on = false;
    engine_set_line(false);
    make_pins_ready();
    begin_axis(&feeds[stepramp_line.leader]);
}

/* ---- stopping ---- */

/* On a line, what is said to any of its axes is meant for the leader, and what is said to others for none. */
static uint8_t axes_meant(uint8_t mask)
{
    if (!line_is_on()) {
        return mask;
    }
    return (mask & line_axes()) != 0 ? feeds[stepramp_line.leader].bit : 0;
}

static void stop_moving(struct feed *feed)
{
    if (feed_is_moving(feed)) {
        stop(feed);
    }
}

static void stop_run(struct feed *feed)
{
    if (feed->axis.runs) {
        stop(feed);
    }
}

void machine_stop(uint8_t mask)
{
    for_each(axes_meant(mask), stop_moving);
}

void machine_stop_runs(void)
{
    for_each(ALL_AXES, stop_run);
}

void machine_halt(uint8_t mask)
{
    mask = axes_meant(mask);
    if (mask == 0) {
        return;
    }
    engine_halt(mask);
    for_each(mask, feed_halted);
    if (line_is_on()) {
        end_line(&stepramp_line_in_progress);
    }
    engine_park(mask);
}

/* ---- the state ---- */

void machine_begin(void)
{
    engine_begin();
    for (uint8_t i = 0; i < MOST_AXES; i++) {
        feeds[i].index = i;
        feeds[i].bit = (uint8_t)(1u << i);
    }
}

/* By so much the direction may turn late [us]: it waits for steps of the other axes, and while it does, for more of
 * those of a fast one. */
static uint16_t latest_turn_us(void)
{
    uint8_t others = (uint8_t)(axis_count - 1);
    return (uint16_t)(STEP_US + 3 * others * (STEP_US + stepramp_machine_settings->pulse_width_us));
}

void machine_use(const uint8_t *new_image, const struct settings *settings)
{
    image = new_image;
    stepramp_machine_settings = settings;
    axis_count = image == NULL ? 0 : ramp_image_axes(image);
    make_pins_ready();
    if (image != NULL) {
        bool is_fast = ramp_image_is_fast(image);
        engine_set_clock(is_fast);
        stepramp_feed_clock.is_fast = is_fast;
        stepramp_feed_clock.setup_ticks = (uint32_t)(stepramp_machine_settings->direction_setup_us + latest_turn_us()) * ticks_a_us();
        for_each((uint8_t)((1u << axis_count) - 1), begin_axis);
    }
}

uint8_t machine_axes(void)
{
    return axis_count;
}

bool machine_is_moving(void)
{
    struct feed *feed = feeds;
    for (uint8_t left = axis_count; left != 0; left--, feed++) {
        if (feed_is_moving(feed)) {
            return true;
        }
    }
    return false;
}

bool machine_is_on_a_line(void)
{
    return line_is_on();
}

/* The steps that the leader of a line will have made when it comes to rest: its target lies ahead all along. */
static OUT_OF_LINE uint32_t steps_of_leader(void)
{
    const struct feed *leader = &feeds[stepramp_line.leader];
    uint32_t distance = (uint32_t)leader->axis.target - (uint32_t)leader->played.position;
    return leader->played.steps_made + without_sign((int32_t)distance);
}

struct axis_report machine_report(uint8_t index)
{
    const struct feed *feed = &feeds[index];
    uint8_t follower = follower_index(feed);
    bool follows = follower != MOST_FOLLOWERS;
    const struct feed *leader = follows ? &feeds[stepramp_line.leader] : feed;
    struct feed_progress progress;
    feed_progress(leader, &progress);
    struct axis_report report = {AXIS_IDLE, progress.position, 0, progress.steps_made};
    if (follows || feed_is_moving(feed)) {
        report.state = leader->axis.stopping ? AXIS_STOPPING : AXIS_MOVING;
    }
    if (follows) {
        report.steps_made = line_steps_of(&stepramp_line_in_progress, follower);
        report.position = feed->played.position;
        axis_move_position(&report.position, feed->pin_backward, report.steps_made);
    } else if (feed_is_moving(feed)) {
        report.interval = feed_interval(feed);
    }
    return report;
}

bool machine_runs(uint8_t index)
{
    return feeds[index].axis.runs;
}

int32_t machine_target(uint8_t index)
{
    const struct feed *feed = &feeds[index];
    uint8_t follower = follower_index(feed);
    if (follower != MOST_FOLLOWERS) {
        int32_t target = feed->played.position;
        axis_move_position(&target, feed->pin_backward, line_steps_with(follower, steps_of_leader()));
        return target;
    }
    if (feed_is_moving(feed) && !feed->axis.runs) {
        return feed->axis.target;
    }
    struct feed_progress progress;
    feed_progress(feed, &progress);
    return progress.position;
}

uint8_t machine_starved(void)
{
    return feed_starved();
}

bool machine_is_enabled(void)
{
    return is_enabled;
}

/* ---- the main loop ---- */

/* The axes that wait for a start; 0 when one of them isn't ready. */
static uint8_t axes_to_start(void)
{
    uint8_t mask = 0;
    struct feed *feed = feeds;
    for (uint8_t left = axis_count; left != 0; left--, feed++) {
        if (feed->stage == FEED_WAITING) {
            if (!feed_is_ready(feed)) {
                return 0;
            }
            mask |= feed->bit;
        }
    }
    return mask;
}

static OUT_OF_LINE void add_time(uint16_t *time, uint16_t passed)
{
    *time = passed > UINT16_MAX - *time ? UINT16_MAX : (uint16_t)(*time + passed);
}

/* Counts the milliseconds that have passed. */
static void pass_time(uint16_t now_ms)
{
    uint16_t passed = (uint16_t)(now_ms - polled_ms);
    polled_ms = now_ms;
    add_time(&enabled_for_ms, passed);
    add_time(&at_rest_for_ms, passed);
    if (machine_is_moving()) {
        at_rest_for_ms = 0;
    }
}

/* Enables the motors. Returns true when they have had time to hold. */
static bool motors_are_ready(void)
{
    if (!is_enabled) {
        is_enabled = true;
        enabled_for_ms = 0;
        board_enable(true);
    }
    return stepramp_machine_settings->enable_lead_ms == 0 || enabled_for_ms > stepramp_machine_settings->enable_lead_ms;
}

/* Disables motors that have been at rest for long enough. */
static void let_go(void)
{
    bool is_for_ever = stepramp_machine_settings->enable_hold_ms == HOLD_FOR_EVER;
    if (is_enabled && !is_for_ever && at_rest_for_ms >= stepramp_machine_settings->enable_hold_ms && !machine_is_moving()) {
        is_enabled = false;
        board_enable(false);
    }
}

/* Ticks from a start to the first segment. An axis whose queue ran dry while it moved has its next interval first: its
 * next step comes late then, but not early. */
static uint16_t start_ticks(uint8_t mask)
{
    uint16_t ticks = (uint16_t)(START_US * ticks_a_us());
    for (struct feed *feed = feeds; mask != 0; feed++, mask >>= 1) {
        if ((mask & 1) != 0 && feed->has_run_dry) {
            uint16_t interval = feed_next_interval(feed);
            ticks = interval > ticks ? interval : ticks;
        }
    }
    return ticks;
}

static void start(uint8_t mask)
{
    uint16_t ticks = start_ticks(mask);
    stepramp_feed_clock.now = board_time();
    engine_start(mask, ticks);
    for (struct feed *feed = feeds; mask != 0; feed++, mask >>= 1) {
        if ((mask & 1) != 0) {
            feed_started(feed, ticks);
        }
    }
}

/* What there is to do once all axes have had their turn. */
static void go_on_together(void)
{
    if (line_is_on() && !feed_is_moving(&feeds[stepramp_line.leader])) {
        end_line(&stepramp_line.played);
    }
    pass_time(board_milliseconds());
    uint8_t mask = axes_to_start();
    if (mask != 0 && motors_are_ready()) {
        start(mask);
    }
    let_go();
}

/* Ends early when something has been received, and goes on then where it was. Not for ever: a line that never falls silent
 * must leave the time to move. */
bool machine_poll(void)
{
    stepramp_feed_clock.now = board_time();
    while (next_axis < axis_count) {
        struct feed *feed = &feeds[next_axis++];
        if (!feed_is_moving(feed)) {
            continue;
        }
        axis_compute(&feed->axis);
        if (!feed_poll(feed)) {
            is_short = true;
        }
        if (board_skip_to_stop()) {
            return false;
        }
        if (!is_short && yields != 0 && board_has_received()) {
            yields--;
            return false;
        }
    }
    bool had_time = !is_short;
    is_short = false;
    next_axis = 0;
    if (!board_has_received()) {
        yields = MOST_YIELDS;
    }
    go_on_together();
    return had_time;
}
