/* What this controller can do: the numbers it reports in its hello. */

#ifndef STEPRAMP_BOARD_LIMITS_H
#define STEPRAMP_BOARD_LIMITS_H

#ifdef ARDUINO
#include "boards/polled/arduino_limits.h"
#endif

#define PROTOCOL_VERSION 2
#define FIRMWARE_MAJOR 0
#define FIRMWARE_MINOR 2
#define FIRMWARE_PATCH 0

/* The step timer's two clocks [Hz]; a ramp image says with which one it is played. All intervals are in its ticks. */
#define FAST_CLOCK_HZ 16000000ul
#define SLOW_CLOCK_HZ 2000000ul

/* Shortest interval [fast ticks] when 1, 2, 3, 4 axes move at the same time: what their step interrupts and the main
 * loop, which keeps the queues filled and the serial port read, need of the processor. */
#ifndef SHORTEST_INTERVAL_1_AXIS_TICKS
#define SHORTEST_INTERVAL_1_AXIS_TICKS 106u
#define SHORTEST_INTERVAL_2_AXES_TICKS 246u
#define SHORTEST_INTERVAL_3_AXES_TICKS 380u
#define SHORTEST_INTERVAL_4_AXES_TICKS 533u
#endif
#define SHORTEST_INTERVALS_TICKS                                                                                       \
    {SHORTEST_INTERVAL_1_AXIS_TICKS, SHORTEST_INTERVAL_2_AXES_TICKS, SHORTEST_INTERVAL_3_AXES_TICKS,                   \
     SHORTEST_INTERVAL_4_AXES_TICKS}

/* Shortest interval [fast ticks] of the axis with most steps, on a straight line of 2, 3, 4 axes. */
#ifndef SHORTEST_INTERVAL_LINE_2_TICKS
#define SHORTEST_INTERVAL_LINE_2_TICKS 133u
#define SHORTEST_INTERVAL_LINE_3_TICKS 160u
#define SHORTEST_INTERVAL_LINE_4_TICKS 177u
#endif
#define SHORTEST_LINE_INTERVALS_TICKS                                                                                  \
    {SHORTEST_INTERVAL_1_AXIS_TICKS, SHORTEST_INTERVAL_LINE_2_TICKS, SHORTEST_INTERVAL_LINE_3_TICKS,                   \
     SHORTEST_INTERVAL_LINE_4_TICKS}

/* Ramps that are computed while they are played. Without, none of them is good. */
#ifndef HAS_FORMULAS
#define HAS_FORMULAS 1
#endif

/* Shortest interval [fast ticks] of a ramp that is computed while it is played: faster, its queue may run dry while a
 * message is answered. Several such axes share it. */
#ifndef SHORTEST_FORMULA_INTERVAL_TICKS
#define SHORTEST_FORMULA_INTERVAL_TICKS 1600u
#endif

/* Shortest interval [fast ticks] of an axis with gauge outputs. */
#ifndef SHORTEST_GAUGE_INTERVAL_TICKS
#define SHORTEST_GAUGE_INTERVAL_TICKS 3200u
#endif

/* Longest interval [ticks]. */
#define LONGEST_INTERVAL_TICKS 0xFFFFFFFul

/* Largest ramp image [bytes], at most 488: a slot of 512 bytes less its header of 12 and the settings. What is missing
 * to that is what an ATmega328P's stack needs of its RAM. */
#ifndef LARGEST_IMAGE_BYTES
#define LARGEST_IMAGE_BYTES 440u
#endif

/* Most segments of a ramp, up and down together. */
#define MOST_SEGMENTS 250u

#define AXES 4

#endif
