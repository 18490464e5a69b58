#include "stepramp/store/driver_settings.h"

#include "stepramp/edge/board_limits.h"

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

#if HAS_INPUTS
enum { LEAST_SILENCE = 2, MOST_SILENCE = 200, MOST_LOOKS = 10 };
enum input_offset { SILENCE = OUTPUT_SETTINGS_BYTES, SILENCE_FLAGS, LOOKS, ROLES };

static bool role_is_good(uint8_t role, uint8_t input)
{
    uint8_t flags = role & (uint8_t)~ROLE_BITS;
    role &= ROLE_BITS;
    if (role == ROLE_NONE) {
        return flags == 0;
    }
    if (role >= ROLE_LOW_LIMIT) {
        return role < ROLE_HIGH_LIMIT + AXES;
    }
    bool is_there = role == ROLE_DRIVER_FAULT || (role == ROLE_EMERGENCY_STOP && input < EMERGENCY_INPUTS);
    return is_there && (flags & INPUT_STOPS_AT_ONCE) == 0;
}

IN_TABLE uint8_t settings_check_inputs(const uint8_t *bytes)
{
    if ((uint8_t)(bytes[SILENCE] - LEAST_SILENCE) > MOST_SILENCE - LEAST_SILENCE) {
        return SILENCE;
    }
    if (bytes[SILENCE_FLAGS] > SILENCE_ENDS_MOVES) {
        return SILENCE_FLAGS;
    }
    if ((uint8_t)(bytes[LOOKS] - 1) >= MOST_LOOKS) {
        return LOOKS;
    }
    uint8_t input = 0;
    while (input < INPUTS && role_is_good(bytes[ROLES + input], input)) {
        input++;
    }
    return (uint8_t)(ROLES + input);
}
#endif

static inline uint8_t check_inputs(const uint8_t *bytes)
{
#if HAS_INPUTS
    if (has_inputs()) {
        return WITH_INPUTS(settings_check_inputs)(bytes);
    }
#endif
    (void)bytes;
    return SETTINGS_BYTES;
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
    return read_u16(bytes + ENABLE_LEAD) > LONGEST_LEAD_MS ? ENABLE_LEAD : check_inputs(bytes);
}
