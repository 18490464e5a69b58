#include "stepramp/motion/share.h"

#include <stdbool.h>

#include "stepramp/edge/board.h"
#include "stepramp/edge/board_limits.h"
#include "stepramp/edge/out_of_line.h"
#include "stepramp/motion/axis.h"
#include "stepramp/motion/homing.h"
#include "stepramp/motion/machine.h"
#include "stepramp/protocol/message.h"

enum { SHARE_BITS = 12 };

/* Cycles that steps take, and wide pulses more. Those are waited for: as much again is left for the main loop. */
static uint16_t cycles_with_pulses(uint16_t cycles, uint8_t pulses)
{
    return (uint16_t)(cycles + pulses * stepramp_machine_settings->pulse_width_us * (FAST_CLOCK_HZ / 1000000u * 2));
}

/* The share of the processor, in 4096ths, of one of `count` axes with this shortest interval [ticks], when all of them
 * together need so many cycles for a step each, and make so many pulses. Rounded down, so that the shortest intervals
 * allowed come to the whole. */
static uint16_t share_of(uint32_t interval, uint16_t cycles, uint8_t pulses, uint8_t count)
{
    if (interval > UINT16_MAX) {
        return 0; /* or nearly so */
    }
    uint8_t fast_ticks_a_tick = stepramp_feed_clock.is_fast ? 1 : FAST_CLOCK_HZ / SLOW_CLOCK_HZ;
    uint32_t fast_ticks = interval * (uint16_t)(fast_ticks_a_tick * count);
    uint32_t share = ((uint32_t)cycles_with_pulses(cycles, pulses) << SHARE_BITS) / fast_ticks;
    return share > UINT16_MAX / MOST_AXES ? UINT16_MAX / MOST_AXES : (uint16_t)share;
}

static OUT_OF_LINE uint8_t share_status(uint16_t share, uint16_t *detail)
{
    if (share <= 1u << SHARE_BITS) {
        return STATUS_OK;
    }
    *detail = (uint16_t)((uint32_t)share * 100 >> SHARE_BITS);
    return STATUS_TOO_FAST;
}

/* The shorter of two intervals, of which the second may be none: 0. */
static uint32_t shorter(uint32_t interval, uint32_t other)
{
    return other != 0 && other < interval ? other : interval;
}

/* The shortest interval that an axis comes to [ticks]: `requested`, or when that is 0, the one told before; until it has
 * slowed down to that, the one at the end of its queue, or the present one. */
static uint32_t shortest_interval(const struct feed *feed, uint32_t requested)
{
    uint32_t interval = shorter(requested != 0 ? requested : feed->axis.level, feed->axis.interval);
    return shorter(interval, feed_step_interval(feed));
}

/* The share of an axis that comes to this interval [ticks] when `count` axes move. Gauges, and ramps that are computed,
 * have their own limits. */
static uint16_t share_of_axis(const struct feed *feed, uint32_t interval, uint8_t count)
{
    if (stepramp_machine_settings->outputs == OUTPUTS_GAUGES) {
        return share_of(interval, board_limit(LIMIT_SHORTEST_GAUGE), 0, 1);
    }
    return axis_is_by_formula(&feed->axis) ? share_of(interval, board_limit(LIMIT_SHORTEST_FORMULA), 1, 1)
                                           : share_of(interval, board_limit((uint8_t)(LIMIT_SHORTEST_1_AXIS - 2 + 2 * count)), count, count);
}

/* Gauges are slow: each has its limit, whatever the others do. A stop that has come in makes an end of it: the
 * divisions take long. */
uint8_t share_check(const struct feed *feeds, uint8_t axes, const uint32_t requested[MOST_AXES], uint16_t *detail)
{
    bool are_gauges = stepramp_machine_settings->outputs == OUTPUTS_GAUGES;
    uint8_t busy = axes_homing(); /* though one may be at rest, between two stages */
    uint8_t count = 0;
    uint16_t sum = 0;
    for (uint8_t i = 0; i < axes; i++) {
        if (requested[i] != 0 || feed_is_moving(&feeds[i])) {
            busy |= feeds[i].bit;
        }
        count = (uint8_t)(count + ((busy & feeds[i].bit) != 0));
    }
    for (; axes != 0; axes--, feeds++, requested++) {
        if (board_skip_to_stop()) {
            *detail = 0;
            return STATUS_OUT_OF_ORDER;
        }
        if ((busy & feeds->bit) != 0) {
            uint32_t interval = shortest_interval(feeds, *requested);
            uint16_t share = share_of_axis(feeds, interval, count);
            sum = are_gauges ? (share > sum ? share : sum) : (uint16_t)(sum + share);
        }
    }
    return share_status(sum, detail);
}

uint8_t share_check_line(uint32_t interval, uint8_t count, uint16_t *detail)
{
    uint8_t at = LIMIT_SHORTEST_1_AXIS;
    if (count > 1) {
        at = (uint8_t)(LIMIT_SHORTEST_LINE_2 - 4 + 2 * count);
    }
    return share_status(share_of(interval, board_limit(at), 1, 1), detail);
}
