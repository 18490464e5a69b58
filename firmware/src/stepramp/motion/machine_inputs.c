#include "stepramp/motion/machine_inputs.h"

#if HAS_INPUTS

#include <string.h>

#include "stepramp/edge/line.h"
#include "stepramp/edge/lateness.h"
#include "stepramp/motion/homing.h"
#include "stepramp/motion/machine.h"
#include "stepramp/motion/machine_axes.h"
#include "stepramp/store/driver_settings.h"

enum { ALL_AXES = (1 << MOST_AXES) - 1 };

/* A pull-up that has just been switched on raises a long cable within some 100 us: what is active is so in all looks. */
enum { LOOKS_AT_NEW_ROLES = 100 };

uint8_t stepramp_known_positions;

static uint16_t active;         /* a bit each */
static uint16_t seen;           /* the same as last looked at */
static uint8_t changed[INPUTS]; /* for so many looks in a row it has been another than it counts as */
static uint8_t stopped_by;
static uint16_t looked_ms;

uint16_t machine_active_inputs(void)
{
    return active;
}

uint8_t machine_stopped_by(void)
{
    return stopped_by;
}

/* The inputs of each role, a bit each: limits by their end, low first. */
static uint16_t emergency_inputs, fault_inputs, limit_inputs[2][MOST_AXES];

void machine_inputs_configure(void)
{
    emergency_inputs = fault_inputs = 0;
    memset(limit_inputs, 0, sizeof limit_inputs);
    uint16_t bit = 1;
    for (uint8_t input = 0; input < INPUTS; input++, bit = (uint16_t)(bit << 1)) {
        uint8_t role = stepramp_machine_settings->roles[input] & ROLE_BITS;
        if (role >= ROLE_LOW_LIMIT) {
            limit_inputs[role >= ROLE_HIGH_LIMIT][role & (MOST_AXES - 1)] |= bit;
        } else if (role == ROLE_EMERGENCY_STOP) {
            emergency_inputs |= bit;
        } else if (role == ROLE_DRIVER_FAULT) {
            fault_inputs |= bit;
        }
    }
}

static inline uint16_t limits_at(uint8_t axis, bool backward)
{
    return limit_inputs[backward ? 0 : 1][axis];
}

uint8_t machine_limit_at(uint8_t axis, bool backward)
{
    uint8_t input = NO_INPUT;
    for (uint16_t there = active & limits_at(axis, backward); there != 0; there >>= 1) {
        input++;
        if ((there & 1) != 0) {
            break;
        }
    }
    return input;
}

bool machine_sees_limit(uint8_t axis, bool backward)
{
    return (seen & limits_at(axis, backward)) != 0;
}

bool machine_has_limit(uint8_t axis, bool backward)
{
    return limits_at(axis, backward) != 0;
}

static bool is_at_a_limit(uint8_t axis)
{
    return (active & (limits_at(axis, true) | limits_at(axis, false))) != 0;
}

bool machine_way_may_be_blocked(uint8_t axis)
{
    return stopped_by != 0 || emergency_is_latched() || is_at_a_limit(axis);
}

uint8_t machine_check_way(uint8_t axis, bool backward, uint16_t *detail)
{
    if (stopped_by != 0 || emergency_is_latched()) {
        *detail = active;
        return STATUS_STOPPED;
    }
    uint8_t input = machine_limit_at(axis, backward);
    if (input != NO_INPUT) {
        *detail = (uint16_t)(input << 8 | axis);
        return STATUS_AT_LIMIT;
    }
    return STATUS_OK;
}

/* ---- soft limits ---- */

int32_t machine_soft_limit(uint8_t axis, bool backward)
{
    if ((stepramp_known_positions >> axis & 1) == 0) {
        return backward ? NO_LOWEST : NO_HIGHEST;
    }
    return (int32_t)read_u32(stepramp_machine_settings->soft_limits[axis] + (backward ? 0 : 4));
}

static uint8_t at_soft_limit(uint8_t axis, bool backward, uint16_t *detail)
{
    *detail = (uint16_t)((backward ? LOWEST_POSITION : HIGHEST_POSITION) << 8 | axis);
    return STATUS_AT_LIMIT;
}

uint8_t machine_check_end(uint8_t axis, int32_t end, uint16_t *detail)
{
    bool is_low = end < machine_soft_limit(axis, true);
    return is_low || end > machine_soft_limit(axis, false) ? at_soft_limit(axis, is_low, detail) : STATUS_OK;
}

uint8_t machine_check_run(uint8_t axis, int32_t interval, uint16_t *detail)
{
    bool backward = interval < 0;
    int32_t limit = machine_soft_limit(axis, backward), from = stepramp_feeds[axis].axis.position;
    bool is_free = interval == 0 || is_no_limit(limit, backward) || (backward ? from > limit : from < limit);
    return is_free ? STATUS_OK : at_soft_limit(axis, backward, detail);
}

uint8_t machine_check_part(uint8_t axis, bool backward, uint32_t steps, uint16_t *detail)
{
    int32_t end = stepramp_feeds[axis].played.position;
    axis_move_position(&end, backward, steps);
    uint8_t status = machine_check_way(axis, backward, detail);
    return status == STATUS_OK ? machine_check_end(axis, end, detail) : status;
}

/* ---- what stops everything ---- */

static void stop_all(uint8_t cause)
{
    stopped_by |= cause;
    if (has_homing()) {
        WITH_HOMING(homing_end)(ALL_AXES);
    }
    machine_halt(ALL_AXES);
}

/* An emergency stop that has been latched since the inputs were looked at: the axes have no events, but don't know it yet. */
static bool is_unseen_stop(void)
{
    return emergency_is_latched() && (stopped_by & BY_EMERGENCY_STOP) == 0;
}

static void look_for_stops(void)
{
    if ((active & emergency_inputs) != 0) {
        emergency_latch();
    }
    if (is_unseen_stop()) {
        stop_all(BY_EMERGENCY_STOP);
    }
    if ((active & fault_inputs) != 0 && (stopped_by & BY_DRIVER_FAULT) == 0) {
        stop_all(BY_DRIVER_FAULT);
    }
}

#if COUNTS_LATENESS
/* ---- lateness ---- */

volatile uint8_t stepramp_late, stepramp_late_from;

/* Other axes' steps make one late by 33 us at most, and by their pulses: that is made up for. When motion has come to be late
 * by more than some 1 ms in all, motors may have lost steps where they stood still, and what is queued lasts longer than the
 * main loop knows. [us], and [256 ticks] for each tick of a microsecond */
enum { MADE_UP_FOR_US = 64, PULSES_MADE_UP_FOR = 4, MOST_LATE = 4 };

/* [256 ticks] An engine has no time to look for less: 384 us of the slow clock. */
enum { LEAST_MADE_UP_FOR = 3 };

void machine_lateness_configure(void)
{
    uint16_t late_us = (uint16_t)(MADE_UP_FOR_US + PULSES_MADE_UP_FOR * stepramp_machine_settings->pulse_width_us);
    uint8_t from = (uint8_t)(((uint16_t)(late_us * machine_ticks_a_us()) >> 8) + 1);
    stepramp_late_from = from < LEAST_MADE_UP_FOR ? LEAST_MADE_UP_FOR : from;
}

/* Forgotten is what was late in a motion that has ended, and after each second what was late while one axis, or a line, moved alone: it
 * only lasts longer by that. Of several axes nobody knows which one it was. */
enum { FORGETTING_BITS = 10 };

static void look_at_lateness(uint16_t changed_ms)
{
    static uint8_t kept; /* of it, as several axes moved */
    uint8_t late = stepramp_late;
    if (late >= machine_ticks_a_us() * MOST_LATE) {
        stop_all(BY_LATENESS);
        stepramp_known_positions = 0;
    }
    uint8_t moving = 0;
    struct feed *last = stepramp_feeds;
    for (struct feed *feed = stepramp_feeds; feed < stepramp_feeds + MOST_AXES; feed++) {
        if (feed_is_moving(feed)) {
            moving++;
            last = feed;
        }
    }
    if (moving > 1) {
        kept = late;
    } else if (moving == 0) {
        stepramp_late = kept = 0;
    } else if (changed_ms >> FORGETTING_BITS != 0) {
        feed_be_late(last, (uint8_t)(late - kept));
        stepramp_late = kept;
    }
}

#endif

bool machine_is_in_emergency(void)
{
    return (stopped_by & BY_EMERGENCY_STOP) != 0 || emergency_is_latched();
}

uint8_t machine_new_stop(const uint8_t before[INPUTS], const uint8_t roles[INPUTS])
{
    uint16_t stays_active = (1u << INPUTS) - 1;
    for (uint8_t left = LOOKS_AT_NEW_ROLES; left != 0; left--) {
        stays_active &= inputs_read();
    }
    for (uint8_t input = 0; input < EMERGENCY_INPUTS; input++) {
        bool is_stop = (roles[input] & ROLE_BITS) == ROLE_EMERGENCY_STOP;
        if ((stays_active >> input & 1) != 0 && is_stop && roles[input] != before[input]) {
            return input;
        }
    }
    active = stays_active; /* so that the next request, too, goes by the new roles */
    return EMERGENCY_INPUTS;
}

/* What nobody has been told yet nobody acknowledges. */
bool machine_acknowledge(void)
{
    if (is_unseen_stop()) {
        return false;
    }
    if ((active & fault_inputs) != 0 || ((active | inputs_read()) & emergency_inputs) != 0) {
        return false;
    }
    if ((stopped_by & BY_EMERGENCY_STOP) != 0) { /* else what is latched by now is a new one */
        emergency_release();
    }
    stopped_by = 0;
    return true;
}

/* ---- limit switches ---- */

/* It is about to move, or moves, backward. */
static bool is_backward(uint8_t axis)
{
    const struct feed *feed = &stepramp_feeds[axis];
    return line_follows(axis) ? feed->pin_backward : axis_goes_backward(&feed->axis);
}

static bool stops_at_once(uint8_t input)
{
    return input != NO_INPUT && (stepramp_machine_settings->roles[input] & INPUT_STOPS_AT_ONCE) != 0;
}

/* It is to turn round, but what is queued still leads into a switch that stops it at once. With its ramp it slows down anyway. */
static OUT_OF_LINE bool must_halt_before_turning(uint8_t axis)
{
    const struct feed *feed = &stepramp_feeds[axis];
    struct feed_progress progress;
    feed_progress(feed, &progress);
    bool steps = feed_is_moving(feed) && progress.steps_made != 0; /* not on a line of another, nor before its direction has turned */
    return steps && stops_at_once(machine_limit_at(axis, progress.backward));
}

static void look_at_limits(void)
{
    for (uint8_t axis = 0; axis < stepramp_axis_count; axis++) {
        if (!is_at_a_limit(axis) || !machine_axis_is_moving(axis)) {
            continue;
        }
        uint8_t input = machine_limit_at(axis, is_backward(axis));
        if (stops_at_once(input) || must_halt_before_turning(axis)) {
            machine_halt((uint8_t)(1u << axis));
        } else if (input != NO_INPUT) {
            machine_stop((uint8_t)(1u << axis));
        }
    }
}

/* ---- looking ---- */

static void look(void)
{
    static bool is_changing;
    seen = inputs_read();
    if (seen == active && !is_changing) { /* as it is nearly always */
        return;
    }
    is_changing = false;
    uint16_t bit = 1;
    for (uint8_t input = 0; input < INPUTS; input++, bit = (uint16_t)(bit << 1)) {
        if (((seen ^ active) & bit) == 0) {
            changed[input] = 0;
        } else if (++changed[input] >= stepramp_machine_settings->looks) {
            changed[input] = 0;
            active ^= bit;
        } else {
            is_changing = true;
        }
    }
}

void machine_watch_inputs(uint16_t now_ms)
{
    uint16_t changed_ms = now_ms ^ looked_ms;
    if (changed_ms != 0) {
        looked_ms = now_ms;
        look();
#if COUNTS_LATENESS
        if (stepramp_late != 0) { /* as it nearly never is */
            look_at_lateness(changed_ms);
        }
#endif
        if (has_homing()) {
            WITH_HOMING(homing_go_on)();
        }
        if (active != 0) {
            look_for_stops();
            look_at_limits();
        }
    }
    if (is_unseen_stop()) {
        look_for_stops();
    }
}

#endif
