/* What a board can do where StepRamp is an Arduino library, played from the sketch's loop(). Each of these numbers may be
 * set before, by the build. */
#ifndef STEPRAMP_ARDUINO_LIMITS_H
#define STEPRAMP_ARDUINO_LIMITS_H

#ifdef __AVR__
#include <avr/io.h>
#endif

/* Largest ramp image [bytes]. A board of 2 KB can't compute ramps. */
#if defined(__AVR__) && RAMEND < 0x1000
#ifndef LARGEST_IMAGE_BYTES
#define LARGEST_IMAGE_BYTES 256u
#endif
#define SHORTEST_FORMULA_INTERVAL_TICKS 0xFFFFu /* none */
#endif
#ifndef LARGEST_IMAGE_BYTES
#define LARGEST_IMAGE_BYTES 440u
#endif

/* A processor of 8 MHz takes twice as long. */
#if defined(__AVR__) && F_CPU < 16000000L
#define AVR_TICKS(ticks) (2u * (ticks))
#else
#define AVR_TICKS(ticks) (ticks)
#endif

/* Shortest intervals [fast ticks, 16 a microsecond]. An Uno looks at the clock every 50 us, and seldom only after 500 to
 * 900 us; these are from 400 us on, measured with the Controller example, 50 reports a second and all axes moving. Other
 * boards are taken to be eight times as fast; none of them has been measured. */
#ifndef SHORTEST_INTERVAL_1_AXIS_TICKS
#ifdef __AVR__
#define SHORTEST_INTERVAL_1_AXIS_TICKS AVR_TICKS(6400u)
#define SHORTEST_INTERVAL_2_AXES_TICKS AVR_TICKS(9600u)
#define SHORTEST_INTERVAL_3_AXES_TICKS AVR_TICKS(12800u)
#define SHORTEST_INTERVAL_4_AXES_TICKS AVR_TICKS(16000u)
#else
#define SHORTEST_INTERVAL_1_AXIS_TICKS 800u
#define SHORTEST_INTERVAL_2_AXES_TICKS 1200u
#define SHORTEST_INTERVAL_3_AXES_TICKS 1600u
#define SHORTEST_INTERVAL_4_AXES_TICKS 2000u
#endif
#endif

#ifndef SHORTEST_INTERVAL_LINE_2_TICKS
#ifdef __AVR__
#define SHORTEST_INTERVAL_LINE_2_TICKS AVR_TICKS(8000u)
#define SHORTEST_INTERVAL_LINE_3_TICKS AVR_TICKS(8800u)
#define SHORTEST_INTERVAL_LINE_4_TICKS AVR_TICKS(9600u)
#else
#define SHORTEST_INTERVAL_LINE_2_TICKS 1000u
#define SHORTEST_INTERVAL_LINE_3_TICKS 1100u
#define SHORTEST_INTERVAL_LINE_4_TICKS 1200u
#endif
#endif

#if !defined(SHORTEST_GAUGE_INTERVAL_TICKS) && defined(__AVR__)
#define SHORTEST_GAUGE_INTERVAL_TICKS AVR_TICKS(9600u)
#elif !defined(SHORTEST_GAUGE_INTERVAL_TICKS)
#define SHORTEST_GAUGE_INTERVAL_TICKS 3200u
#endif

/* Not measured: a Mega computes formulas in C. */
#if !defined(SHORTEST_FORMULA_INTERVAL_TICKS) && defined(__AVR__)
#define SHORTEST_FORMULA_INTERVAL_TICKS AVR_TICKS(16000u)
#elif !defined(SHORTEST_FORMULA_INTERVAL_TICKS)
#define SHORTEST_FORMULA_INTERVAL_TICKS 1600u
#endif

/* From the start of a queue to its first segment [us]: longer than a round of the loop with all axes and a report. */
#ifndef START_US
#define START_US 1500
#endif

/* A step that is late by more than this [us] is not caught up with: the whole motion is late from then on instead. So
 * no interval is shorter than planned by more. */
#ifndef STEPRAMP_MOST_CATCH_UP_US
#ifdef __AVR__
#define STEPRAMP_MOST_CATCH_UP_US 100
#else
#define STEPRAMP_MOST_CATCH_UP_US 12
#endif
#endif

/* What a step's pulse lasts at least [us]; on an AVR digitalWrite takes as long. */
#ifndef STEPRAMP_SHORTEST_PULSE_US
#ifdef __AVR__
#define STEPRAMP_SHORTEST_PULSE_US 0
#else
#define STEPRAMP_SHORTEST_PULSE_US 3
#endif
#endif

#endif
