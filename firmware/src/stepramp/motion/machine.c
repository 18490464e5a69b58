#include "stepramp/motion/machine.h"

#include <stddef.h>

#include "stepramp/edge/board.h"
#include "stepramp/edge/board_limits.h"
#include "stepramp/edge/line.h"
#include "stepramp/edge/out_of_line.h"
#include "stepramp/edge/step_queue.h"
#include "stepramp/motion/feed.h"
#include "stepramp/motion/homing.h"
#include "stepramp/motion/machine_axes.h"
#include "stepramp/motion/machine_inputs.h"
#include "stepramp/motion/share.h"
#include "stepramp/store/driver_settings.h"
#include "stepramp/store/ramp_image.h"

enum { MOST_GAUGES = 3 };

enum { ALL_AXES = (1 << MOST_AXES) - 1 };

/* What a step takes of the processor without its pulse, and when a segment begins with it [us]. */
enum { STEP_US = 10 };

const uint8_t *stepramp_image;
const struct settings *stepramp_machine_settings;
struct feed stepramp_feeds[MOST_AXES];
uint8_t stepramp_axis_count;
#if HAS_INPUTS
uint8_t stepramp_homing_axes; /* here, as homing isn't in each sketch */
#endif

/* [ticks] */
static OUT_OF_LINE uint32_t slew_interval_of(const struct feed *feed)
{
    return ramp_image_slew_interval(stepramp_image, feed->index);
}

/* Does something with each axis of a mask. */
static void for_each(uint8_t mask, void (*act)(struct feed *feed))
{
    for (struct feed *feed = stepramp_feeds; mask != 0; feed++, mask >>= 1) {
        if ((mask & 1) != 0) {
            act(feed);
        }
    }
}

/* ---- requests ---- */

uint8_t machine_check_mask(uint8_t mask, uint16_t *detail)
{
    if (stepramp_image == NULL) {
        *detail = 0;
        return STATUS_NO_RAMP;
    }
    *detail = mask;
    bool is_known = mask != 0 && mask >> stepramp_axis_count == 0;
    bool has_pins = stepramp_machine_settings->outputs != OUTPUTS_GAUGES || mask >> MOST_GAUGES == 0;
    return is_known && has_pins ? STATUS_OK : STATUS_OUT_OF_RANGE;
}

OUT_OF_LINE uint32_t machine_without_sign(int32_t number)
{
    return number < 0 ? 0u - (uint32_t)number : (uint32_t)number;
}

/* The interval that is requested of an axis of the mask [ticks]; 0: a run at no speed, which is a stop. */
static uint32_t requested_interval(const struct feed *feed, int32_t value, bool is_run)
{
    return is_run ? machine_without_sign(value) : slew_interval_of(feed);
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

#if HAS_INPUTS
/* At a soft limit, if there is one. */
IN_TABLE void machine_end_run(struct feed *feed, bool backward)
{
    int32_t end = machine_soft_limit(feed->index, backward);
    if (!is_no_limit(end, backward)) {
        axis_end_run(&feed->axis, end);
    }
}
#endif

static void begin_order(struct feed *feed, uint32_t interval, int32_t value, bool is_run)
{
    if (interval == 0) {
        stop(feed);
        return;
    }
    if (is_run) {
        axis_run(&feed->axis, value < 0, interval, interval == slew_interval_of(feed));
#if HAS_INPUTS
        if (has_inputs()) {
            WITH_INPUTS(machine_end_run)(feed, value < 0);
        }
#endif
    } else {
        axis_move_to(&feed->axis, interval, value);
    }
    feed_set_out(feed);
}

#if HAS_INPUTS
/* Nothing keeps an axis from setting out: STATUS_OK, or what does. To one that stays where it is a limit is in no way, but an emergency stop is. */
static uint8_t check_way(uint8_t axis, int32_t value, bool is_run, uint16_t *detail)
{
    if (!machine_way_may_be_blocked(axis)) {
        return STATUS_OK;
    }
    int32_t from = is_run ? 0 : machine_position(axis); /* which takes a while */
    uint8_t status = machine_check_way(axis, value < from, detail);
    return value == from && status == STATUS_AT_LIMIT ? STATUS_OK : status;
}

IN_TABLE uint8_t machine_check_ways(uint8_t mask, const int32_t *values, bool is_run, uint16_t *detail)
{
    uint8_t status = STATUS_OK;
    for (uint8_t axis = 0; mask != 0 && status == STATUS_OK; axis++, mask >>= 1) {
        if ((mask & 1) != 0) {
            int32_t value = *values++;
            status = check_way(axis, value, is_run, detail);
            if (status == STATUS_OK) {
                status = is_run ? machine_check_run(axis, value, detail) : machine_check_end(axis, value, detail);
            }
        }
    }
    return status;
}
#endif

static inline uint8_t check_ways(uint8_t mask, const int32_t *values, bool is_run, uint16_t *detail)
{
#if HAS_INPUTS
    if (has_inputs()) {
        return WITH_INPUTS(machine_check_ways)(mask, values, is_run, detail);
    }
#endif
    (void)mask, (void)values, (void)is_run, (void)detail;
    return STATUS_OK;
}

/* Moves the axes of the mask to positions, or runs them at intervals with a sign. */
static uint8_t order(uint8_t mask, const int32_t *values, bool is_run, uint16_t *detail)
{
    uint32_t requested[MOST_AXES] = {0};
    uint8_t status = machine_check_mask(mask, detail);
    if (status != STATUS_OK) {
        return status;
    }
    const int32_t *value = values;
    uint32_t *interval_of = requested;
    struct feed *feed = stepramp_feeds;
    for (uint8_t left = stepramp_axis_count; left != 0; left--, feed++) {
        uint32_t interval = (mask & feed->bit) != 0 ? requested_interval(feed, *value++, is_run) : 0;
        *interval_of++ = interval;
        if (interval != 0 && (interval < slew_interval_of(feed) || interval > LONGEST_INTERVAL_TICKS)) {
            *detail = feed->index;
            return STATUS_OUT_OF_RANGE;
        }
    }
    status = check_ways(mask, values, is_run, detail);
    if (status == STATUS_OK) {
        status = share_check(stepramp_feeds, stepramp_axis_count, requested, detail);
    }
    if (status != STATUS_OK) {
        return status;
    }
    interval_of = requested;
    for (struct feed *feed = stepramp_feeds; mask != 0; feed++, mask >>= 1, interval_of++) {
        if ((mask & 1) != 0) {
            begin_order(feed, *interval_of, *values++, is_run);
        }
    }
    return STATUS_OK;
}

uint8_t machine_move_to(uint8_t mask, const int32_t *targets, uint16_t *detail)
{
    return order(mask, targets, false, detail);
}

uint8_t machine_run(uint8_t mask, const int32_t *intervals, uint16_t *detail)
{
    return order(mask, intervals, true, detail);
}

void machine_set_position(uint8_t mask, const int32_t *positions)
{
#if HAS_INPUTS
    uint8_t known = mask;
#endif
    for (struct feed *feed = stepramp_feeds; mask != 0; feed++, mask >>= 1) {
        if ((mask & 1) != 0) {
            int32_t position = *positions++;
            feed->played.position = position;
            axis_halt(&feed->axis, position);
        }
    }
#if HAS_INPUTS
    stepramp_known_positions |= known;
#endif
}

static void place(struct feed *feed, int32_t position)
{
    feed->played.position = position;
    feed->axis.position = position;
}

uint8_t machine_zero(uint8_t mask, uint16_t steps, uint16_t *detail)
{
    const int32_t zeros[MOST_AXES] = {0};
    struct feed *feed = stepramp_feeds;
    for (uint8_t left = stepramp_axis_count; left != 0; left--, feed++) {
        if ((mask & feed->bit) != 0) {
            place(feed, steps); /* from there it sets out backward */
        }
    }
#if HAS_INPUTS
    uint8_t known = stepramp_known_positions;
    stepramp_known_positions = 0; /* it goes to wherever a stop is */
#endif
    uint8_t status = machine_move_to(mask, zeros, detail);
#if HAS_INPUTS
    stepramp_known_positions = status == STATUS_OK ? known & (uint8_t)~mask : known;
#endif
    feed = stepramp_feeds;
    for (uint8_t left = stepramp_axis_count; left != 0; left--, feed++) {
        if ((mask & feed->bit) == 0) {
            continue;
        }
        if (status != STATUS_OK) {
            place(feed, feed->axis.target); /* where it was: it is at rest */
        }
#if HAS_INPUTS
        feed->axis.seeks_zero = status == STATUS_OK;
#endif
    }
    return status;
}

/* ---- at rest ---- */

static void point_forward(struct feed *feed)
{
    feed->pin_backward = false;
    feed->played.backward = false;
    feed->turns_too = 0;
}

void machine_make_pins_ready(void)
{
    board_configure(stepramp_machine_settings);
    for_each(ALL_AXES, point_forward);
}

void machine_begin_axis(struct feed *feed)
{
    struct image_ramp ramp = ramp_image_ramp(stepramp_image, feed->index);
    axis_begin(&feed->axis, &ramp);
    axis_halt(&feed->axis, feed->played.position);
}

/* ---- stopping ---- */

/* On a line, what is said to any of its axes is meant for the leader, and what is said to others for none. */
static uint8_t axes_meant(uint8_t mask)
{
    if (!line_is_on()) {
        return mask;
    }
    return line_leader_of(mask);
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

#if HAS_INPUTS
/* Where a motor is that was halted faster than its ramp begins nobody knows. On a line that is so of all. */
IN_TABLE void machine_forget_fast(uint8_t mask)
{
    for (const struct feed *feed = stepramp_feeds; mask != 0; feed++, mask >>= 1) {
        uint32_t interval = (mask & 1) != 0 && feed_has_stepped(feed) ? feed_interval(feed) : 0;
        if (interval > LONGEST_WAIT_TICKS) { /* how long that is as a whole is known only where no ramp has led to it */
            interval = feed->has_ramped ? LONGEST_WAIT_TICKS + 1u : 0;
        }
        if (interval != 0 && interval < axis_slowest(&feed->axis)) {
            stepramp_known_positions &= line_is_on() ? 0 : (uint8_t)~feed->bit;
        }
    }
}
#endif

static inline void forget_fast(uint8_t mask)
{
#if HAS_INPUTS
    if (has_inputs()) {
        WITH_INPUTS(machine_forget_fast)(mask);
    }
#endif
    (void)mask;
}

void machine_halt(uint8_t mask)
{
    mask = axes_meant(mask);
    if (mask == 0) {
        return;
    }
    step_queue_halt(mask);
    forget_fast(mask);
    for_each(mask, feed_halted);
    if (line_is_on()) {
        machine_end_line();
    }
    step_queue_clear(mask);
}

/* ---- the state ---- */

struct feed *machine_leader(void)
{
    return &stepramp_feeds[line_leader()];
}

uint8_t machine_ticks_a_us(void)
{
    return stepramp_feed_clock.is_fast ? FAST_CLOCK_HZ / 1000000u : SLOW_CLOCK_HZ / 1000000u;
}

void machine_begin(void)
{
    step_queue_begin();
    for (uint8_t i = 0; i < MOST_AXES; i++) {
        stepramp_feeds[i].index = i;
        stepramp_feeds[i].bit = (uint8_t)(1u << i);
    }
}

/* By so much the direction may turn late [us]: it waits for steps of the other axes, and while it does, for more of
 * those of a fast one. */
static uint16_t latest_turn_us(void)
{
    uint8_t others = (uint8_t)(stepramp_axis_count - 1);
    return (uint16_t)(STEP_US + 3 * others * (STEP_US + stepramp_machine_settings->pulse_width_us));
}

void machine_use(const uint8_t *new_image, const struct settings *settings)
{
    stepramp_image = new_image;
    stepramp_machine_settings = settings;
    stepramp_axis_count = stepramp_image == NULL ? 0 : ramp_image_axes(stepramp_image);
    machine_make_pins_ready();
#if HAS_INPUTS
    if (has_inputs()) {
        WITH_INPUTS(machine_inputs_configure)();
    }
#endif
    if (stepramp_image != NULL) {
        bool is_fast = ramp_image_is_fast(stepramp_image);
        step_queue_set_clock(is_fast);
        stepramp_feed_clock.is_fast = is_fast;
        stepramp_feed_clock.setup_ticks = (uint32_t)(stepramp_machine_settings->direction_setup_us + latest_turn_us()) * machine_ticks_a_us();
        for_each((uint8_t)((1u << stepramp_axis_count) - 1), machine_begin_axis);
#if COUNTS_LATENESS
        machine_lateness_configure();
#endif
    }
}

uint8_t machine_axes(void)
{
    return stepramp_axis_count;
}

bool machine_is_moving(void)
{
    if (axes_homing() != 0) {
        return true;
    }
    struct feed *feed = stepramp_feeds;
    for (uint8_t left = stepramp_axis_count; left != 0; left--, feed++) {
        if (feed_is_moving(feed)) {
            return true;
        }
    }
    return false;
}
