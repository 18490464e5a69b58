/* What is done in each round of the main loop: queues are kept filled and started, motors enabled. */
#include "stepramp/motion/machine.h"

#include "stepramp/edge/board.h"
#include "stepramp/edge/board_limits.h"
#include "stepramp/edge/line.h"
#include "stepramp/edge/out_of_line.h"
#include "stepramp/edge/step_queue.h"
#include "stepramp/motion/feed.h"
#include "stepramp/motion/machine_axes.h"

/* So often moves make way for what has been received, until the line has been silent: enough for a request. */
enum { MOST_YIELDS = 4 };

static uint8_t next_axis;  /* whose turn it is */
static bool is_short;      /* of what is queued for one of the axes before it */
static bool is_enabled;
static uint16_t polled_ms;      /* when the main loop came round last */
static uint16_t enabled_for_ms; /* for so long the motors have been enabled, */
static uint16_t at_rest_for_ms; /* and at rest. 65535 stays 65535, however long that is */
static uint8_t yields; /* so often what has been received may still come first, before all axes have had their turn */

bool machine_is_enabled(void)
{
    return is_enabled;
}

/* The axes that wait for a start; 0 when one of them isn't ready. */
static uint8_t axes_to_start(void)
{
    uint8_t mask = 0;
    struct feed *feed = stepramp_feeds;
    for (uint8_t left = stepramp_axis_count; left != 0; left--, feed++) {
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
    if (!is_enabled) { /* as before there are settings */
        return;
    }
    uint16_t hold_ms = stepramp_machine_settings->enable_hold_ms;
    if (hold_ms != HOLD_FOR_EVER && at_rest_for_ms >= hold_ms && !machine_is_moving()) {
        is_enabled = false;
        board_enable(false);
    }
}

/* Ticks from a start to the first segment. An axis whose queue ran dry while it moved has its next interval first: its
 * next step comes late then, but not early. */
static uint16_t start_ticks(uint8_t mask)
{
    uint16_t ticks = (uint16_t)(board_limit(LIMIT_START_US) * machine_ticks_a_us());
    for (struct feed *feed = stepramp_feeds; mask != 0; feed++, mask >>= 1) {
        if ((mask & 1) != 0 && feed->has_run_dry) {
            uint16_t interval = step_queue_next(feed->index).ticks;
            ticks = interval > ticks ? interval : ticks;
        }
    }
    return ticks;
}

static void start(uint8_t mask)
{
    uint16_t ticks = start_ticks(mask);
    stepramp_feed_clock.now = board_time();
    step_queue_start(mask, ticks);
    for (struct feed *feed = stepramp_feeds; mask != 0; feed++, mask >>= 1) {
        if ((mask & 1) != 0) {
            feed_started(feed, ticks);
        }
    }
}

/* What there is to do once all axes have had their turn. */
static void go_on_together(void)
{
    if (line_is_on() && !feed_is_moving(machine_leader())) {
        line_look();
        machine_end_line();
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
    while (next_axis < stepramp_axis_count) {
        struct feed *feed = &stepramp_feeds[next_axis++];
        if (!feed_is_moving(feed)) {
            continue;
        }
        stepramp_feed_clock.now = board_time(); /* a round of several axes at full speed takes milliseconds */
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
