/* The processor's share: how much of it steps take, and what is too fast for it. */
#ifndef STEPRAMP_SHARE_H
#define STEPRAMP_SHARE_H

#include <stdint.h>

#include "stepramp/edge/step_queue.h"
#include "stepramp/motion/feed.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Whether axes can move with these intervals [ticks], 0 for those that go on as they do: STATUS_OK; STATUS_TOO_FAST,
 * and in the detail the share of the processor [%] that they would take; or STATUS_OUT_OF_ORDER, when a stop has come
 * in. */
uint8_t share_check(const struct feed *feeds, uint8_t axes, const uint32_t requested[MOST_AXES], uint16_t *detail);

/* The same of a line of `count` axes that make steps, whose leader comes to this interval [ticks]. */
uint8_t share_check_line(uint32_t interval, uint8_t count, uint16_t *detail);

#ifdef __cplusplus
}
#endif

#endif
