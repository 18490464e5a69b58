#include "stepramp/store/driver_settings.h"

enum { AXIS_BITS = 0x0F };
enum { LONGEST_PULSE_US = 100, SHORTEST_SETUP_US = 20, LONGEST_SETUP_US = 15000, LONGEST_LEAD_MS = 1000 };

/* Where the settings lie when packed. */
enum offset { OUTPUTS = 0, BOTH_EDGES = 1, ENABLE_FLAGS = 4, PULSE_WIDTH = 5, DIRECTION_SETUP = 6, ENABLE_LEAD = 8 };

/* The largest value of each setting that is one byte; in less room than a table. */
static uint8_t largest(uint8_t offset)
{
    return offset == OUTPUTS        ? OUTPUTS_GAUGES
           : offset == ENABLE_FLAGS ? ENABLE_ACTIVE_HIGH
           : offset == PULSE_WIDTH  ? LONGEST_PULSE_US
                                    : AXIS_BITS;
}

uint8_t settings_check(const uint8_t bytes[SETTINGS_BYTES])
{
    for (uint8_t i = OUTPUTS; i <= PULSE_WIDTH; i++) {
        if (bytes[i] > largest(i)) {
            return i;
        }
    }
    uint16_t above_us = (uint16_t)(read_u16(bytes + DIRECTION_SETUP) - SHORTEST_SETUP_US);
    if (above_us > LONGEST_SETUP_US - SHORTEST_SETUP_US) {
        return DIRECTION_SETUP;
    }
    return read_u16(bytes + ENABLE_LEAD) > LONGEST_LEAD_MS ? ENABLE_LEAD : SETTINGS_BYTES;
}
