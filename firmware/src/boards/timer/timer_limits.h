/* What a sketch can do whose steps are made by a timer's interrupt, at 16 MHz. */
#ifndef STEPRAMP_TIMER_LIMITS_H
#define STEPRAMP_TIMER_LIMITS_H

#include "boards/polled/arduino_limits.h"
#include "stepramp/edge/build_options.h"

#undef SHORTEST_INTERVAL_1_AXIS_TICKS
#undef SHORTEST_INTERVAL_2_AXES_TICKS
#undef SHORTEST_INTERVAL_3_AXES_TICKS
#undef SHORTEST_INTERVAL_4_AXES_TICKS
#undef SHORTEST_INTERVAL_LINE_2_TICKS
#undef SHORTEST_INTERVAL_LINE_3_TICKS
#undef SHORTEST_INTERVAL_LINE_4_TICKS
#undef SHORTEST_GAUGE_INTERVAL_TICKS
#undef START_US

/* Shortest interval [fast ticks] when 1, 2, 3, 4 axes move at the same time: 100,000, 50,000, 33,333 and 25,000 steps/s. */
#define SHORTEST_INTERVAL_1_AXIS_TICKS 160u
#define SHORTEST_INTERVAL_2_AXES_TICKS 320u
#define SHORTEST_INTERVAL_3_AXES_TICKS 480u
#define SHORTEST_INTERVAL_4_AXES_TICKS 640u

/* The same of the axis with most steps, on a straight line of 2, 3, 4 axes. */
#define SHORTEST_INTERVAL_LINE_2_TICKS 240u
#define SHORTEST_INTERVAL_LINE_3_TICKS 280u
#define SHORTEST_INTERVAL_LINE_4_TICKS 320u

/* Of an axis with gauge outputs. */
#define SHORTEST_GAUGE_INTERVAL_TICKS 6400u

/* Of a ramp that is computed while it is played; several such axes share it. */
#if HAS_FORMULAS
#undef SHORTEST_FORMULA_INTERVAL_TICKS
#define SHORTEST_FORMULA_INTERVAL_TICKS 3200u
#endif

/* From the start of a queue to its first segment [us]: time to queue some more. */
#define START_US 200

#endif
