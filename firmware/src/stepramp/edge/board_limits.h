/* What a board can do: numbers that it gives as a table, which is also what it tells in its hello; and those that are the
 * same for all. */
#ifndef STEPRAMP_BOARD_LIMITS_H
#define STEPRAMP_BOARD_LIMITS_H

#include <stdint.h>

#include "stepramp/edge/in_flash.h"

#ifdef __cplusplus
extern "C" {
#endif

#define PROTOCOL_VERSION 3
#define OLDEST_PROTOCOL_VERSION 2
#define FIRMWARE_MAJOR 0
#define FIRMWARE_MINOR 2
#define FIRMWARE_PATCH 0

/* The step timer's two clocks [Hz]; a ramp image says with which one it is played. All intervals are in its ticks. */
#define FAST_CLOCK_HZ 16000000ul
#define SLOW_CLOCK_HZ 2000000ul

/* Longest interval [ticks]. */
#define LONGEST_INTERVAL_TICKS 0xFFFFFFFul

/* Most segments of a ramp, up and down together. */
#define MOST_SEGMENTS 250u

#define AXES 4

/* Where they are in the table [bytes]. Intervals are in fast ticks. */
enum board_limit {
    LIMIT_SHORTEST_1_AXIS = 12, /* when 1, 2, 3, 4 axes move at the same time */
    LIMIT_SHORTEST_LINE_2 = 20, /* of the axis with most steps, on a straight line of 2, 3, 4 axes */
    LIMIT_SHORTEST_FORMULA = 30,
    LIMIT_IMAGE_BYTES = 32,
    TOLD_LIMITS_BYTES = 36,
    LIMIT_SHORTEST_GAUGE = TOLD_LIMITS_BYTES,
    LIMIT_START_US = 38,
    BOARD_LIMITS_BYTES = 40
};

/* What a build has, as its hello tells. */
enum capability { HAS_FORMULA_RAMPS = 1, HAS_GAUGE_OUTPUTS = 2, HAS_MACHINE_INPUTS = 4, KEEPS_WITHOUT_POWER = 8, HAS_SOFT_LIMITS = 16 };

/* Little-endian bytes of a number. */
#define BYTES_U16(number) (number) & 0xFF, (number) >> 8
#define BYTES_U32(number) BYTES_U16((number) & 0xFFFF), BYTES_U16((number) >> 16)

/* A board's file defines the numbers, and makes the table of them. */
#define BOARD_LIMITS                                                                                                   \
    {                                                                                                                  \
        PROTOCOL_VERSION, FIRMWARE_MAJOR, FIRMWARE_MINOR, FIRMWARE_PATCH, BYTES_U32(FAST_CLOCK_HZ),                    \
            BYTES_U32(SLOW_CLOCK_HZ), BYTES_U16(SHORTEST_INTERVAL_1_AXIS_TICKS),                                       \
            BYTES_U16(SHORTEST_INTERVAL_2_AXES_TICKS), BYTES_U16(SHORTEST_INTERVAL_3_AXES_TICKS),                      \
            BYTES_U16(SHORTEST_INTERVAL_4_AXES_TICKS), BYTES_U16(SHORTEST_INTERVAL_LINE_2_TICKS),                      \
            BYTES_U16(SHORTEST_INTERVAL_LINE_3_TICKS), BYTES_U16(SHORTEST_INTERVAL_LINE_4_TICKS),                      \
            BYTES_U32(LONGEST_INTERVAL_TICKS), BYTES_U16(SHORTEST_FORMULA_INTERVAL_TICKS),                             \
            BYTES_U16(LARGEST_IMAGE_BYTES), MOST_SEGMENTS, AXES, BYTES_U16(SHORTEST_GAUGE_INTERVAL_TICKS),             \
            BYTES_U16(START_US)                                                                                        \
    }

#if defined(ARDUINO) && defined(__AVR__)
/* A sketch that has chosen a timer has another table: this tells which one it is, in flash. */
const void *arduino_limits(void);
#define stepramp_board_limits ((const IN_FLASH uint8_t *)arduino_limits())
#else
extern const IN_FLASH uint8_t stepramp_board_limits[BOARD_LIMITS_BYTES];
#endif

/* One of two bytes. */
uint16_t board_limit(uint8_t at);

#ifdef __cplusplus
}
#endif

#endif
