/* What an engine may tell of lateness, where a build counts it. Its steps may be late by what other interrupts take, and make up for
 * that: an event that is past comes at once. One that is later than `late_from` isn't made up for: it comes an interval after the
 * one before, all behind it so much later, and `late` counts by how much, up to 255. It is looked for where an event is past when
 * the one before ends: what is late by less than its interval isn't seen. Both are of 256 ticks; the main loop sets them. */
#ifndef STEPRAMP_LATENESS_H
#define STEPRAMP_LATENESS_H

#include <stdint.h>

#include "stepramp/edge/build_options.h"

#ifdef __cplusplus
extern "C" {
#endif

#if COUNTS_LATENESS
extern volatile uint8_t stepramp_late, stepramp_late_from;
#endif

#ifdef __cplusplus
}
#endif

#endif
