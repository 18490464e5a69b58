/* What the controller on an ATmega328P at 16 MHz can do. */
#ifndef STEPRAMP_AVR_LIMITS_H
#define STEPRAMP_AVR_LIMITS_H

#include "stepramp/edge/build_options.h"

/* Shortest interval [fast ticks] when 1, 2, 3, 4 axes move at the same time: what their step interrupts and the main
 * loop, which keeps the queues filled and the serial port read, need of the processor. */
#define SHORTEST_INTERVAL_1_AXIS_TICKS 106u
#define SHORTEST_INTERVAL_2_AXES_TICKS 246u
#define SHORTEST_INTERVAL_3_AXES_TICKS 388u
#define SHORTEST_INTERVAL_4_AXES_TICKS 533u

/* Shortest interval [fast ticks] of the axis with most steps, on a straight line of 2, 3, 4 axes. */
#if HAS_INPUTS /* which are looked at all the time */
#define SHORTEST_INTERVAL_LINE_2_TICKS 136u
#define SHORTEST_INTERVAL_LINE_3_TICKS 164u
#define SHORTEST_INTERVAL_LINE_4_TICKS 184u
#else
#define SHORTEST_INTERVAL_LINE_2_TICKS 133u
#define SHORTEST_INTERVAL_LINE_3_TICKS 160u
#define SHORTEST_INTERVAL_LINE_4_TICKS 181u
#endif

/* Shortest interval [fast ticks] of a ramp that is computed while it is played: faster, its queue may run dry while a
 * message is answered. Several such axes share it. */
#define SHORTEST_FORMULA_INTERVAL_TICKS 1600u

/* Shortest interval [fast ticks] of an axis with gauge outputs. */
#define SHORTEST_GAUGE_INTERVAL_TICKS 3200u

/* Largest ramp image [bytes], at most 488: a slot of 512 bytes less its header of 12 and the settings. What is missing
 * to that is what an ATmega328P's stack needs of its RAM: with inputs, 48 bytes stay untouched even when an emergency stop
 * comes in at the deepest of all calls. */
#if HAS_INPUTS
#define LARGEST_IMAGE_BYTES 336u
#else
#define LARGEST_IMAGE_BYTES 440u
#endif

/* From the start of a queue to its first segment [us]: time to queue some more. */
#define START_US 200

#endif
