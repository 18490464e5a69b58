/* What a build leaves out where memory is short. Each may be set before, by the build. */
#ifndef STEPRAMP_BUILD_OPTIONS_H
#define STEPRAMP_BUILD_OPTIONS_H

#if defined(ARDUINO) && defined(__AVR__)
#include <avr/io.h>

#if RAMEND < 0x1000
/* An Uno's 2 KB of RAM and 32 KB of flash. The line's queue is the memory of the axes' queues; formulas are left out. */
#define STEPRAMP_SHARED_QUEUES
#define HAS_FORMULAS 0
#define QUEUE_SEGMENTS 8
#define QUEUE_BYTES 64
#endif
#endif

/* Ramps that are computed while they are played. Without, none of them is good. */
#ifndef HAS_FORMULAS
#define HAS_FORMULAS 1
#endif

/* Emergency stop, drivers' faults, limit switches, homing: inputs.h. A sketch has them, and as long as it asks for none the
 * linker leaves them out. */
#ifndef HAS_INPUTS
#ifdef ARDUINO
#define HAS_INPUTS 1
#else
#define HAS_INPUTS 0
#endif
#endif

/* Whether a program with inputs can tell that its steps came late: lateness.h. */
#if HAS_INPUTS && defined(STEPRAMP_COUNTS_LATENESS)
#define COUNTS_LATENESS 1
#else
#define COUNTS_LATENESS 0
#endif

/* So long is queued ahead [64 us]: 8 ms, and 12 ms in a sketch, whose loop() has other things to do. */
#ifndef TICKS_AHEAD
#ifdef ARDUINO
#define TICKS_AHEAD 187
#else
#define TICKS_AHEAD 125
#endif
#endif

/* Of an axis. */
#ifndef QUEUE_SEGMENTS
#define QUEUE_SEGMENTS 16
#define QUEUE_BYTES 128
#endif

#endif
