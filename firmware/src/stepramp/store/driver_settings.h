/* The settings of a machine: what its motors' drivers want of the pins, and what its inputs are for. Stored next to the ramps. */
#ifndef STEPRAMP_DRIVER_SETTINGS_H
#define STEPRAMP_DRIVER_SETTINGS_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "stepramp/edge/board_limits.h"
#include "stepramp/edge/inputs.h"
#include "stepramp/protocol/message.h"

#ifdef __cplusplus
extern "C" {
#endif

enum outputs { OUTPUTS_STEP_AND_DIRECTION = 0, OUTPUTS_GAUGES = 1 };

enum { ENABLE_ACTIVE_HIGH = 1 };

enum { HOLD_FOR_EVER = 0xFFFF };

/* Packed, as they travel and are stored; the first of them are those of the outputs, which are all without inputs. */
enum { OUTPUT_SETTINGS_BYTES = 12, SETTINGS_BYTES = HAS_INPUTS ? OUTPUT_SETTINGS_BYTES + 3 + INPUTS : OUTPUT_SETTINGS_BYTES };

/* Soft limits follow as they are stored; they travel on their own, an axis at a time. */
enum { SOFT_LIMITS_BYTES = 8, STORED_SETTINGS_BYTES = SETTINGS_BYTES + (HAS_INPUTS ? SOFT_LIMITS_BYTES * AXES : 0) };

/* Of an input; a limit's axis is added to it. */
enum input_role {
    ROLE_NONE = 0,
    ROLE_EMERGENCY_STOP = 1,
    ROLE_DRIVER_FAULT = 2,
    ROLE_LOW_LIMIT = 8,
    ROLE_HIGH_LIMIT = 12,
    ROLE_BITS = 0x1F
};

/* Added to a role. */
enum input_flags { INPUT_STOPS_AT_ONCE = 0x20, INPUT_ACTIVE_HIGH = 0x40, INPUT_WITHOUT_PULL_UP = 0x80 };

enum { SILENCE_ENDS_MOVES = 1 };

/* A client that has not been heard for so long runs no motor, unless the settings say another time [256 ms]. */
enum { USUAL_SILENCE = 4 };

struct settings {
    uint8_t outputs;             /* enum outputs */
    uint8_t both_edges;          /* bit per axis: each edge of the step pin is a step */
    uint8_t step_inverted;       /* bit per axis: the step pin rests high */
    uint8_t direction_inverted;  /* bit per axis: forward is low */
    uint8_t enable_flags;        /* ENABLE_ACTIVE_HIGH, or 0: the enable pin is active low */
    uint8_t pulse_width_us;      /* 0: as short as the engine's own; else at least so long, up to 100 */
    uint16_t direction_setup_us; /* 20..15000: from the direction to the pulse */
    uint16_t enable_lead_ms;     /* 0..1000: from enabling to the first pulse */
    uint16_t enable_hold_ms;     /* from the last motor's rest to disabling, or HOLD_FOR_EVER: stays on once on */
#if HAS_INPUTS
    uint8_t silence;       /* 2..200: runs end when nobody has been heard for longer [256 ms] */
    uint8_t silence_flags; /* SILENCE_ENDS_MOVES, or 0 */
    uint8_t looks;         /* 1..10: so many in a row, until an input has changed */
    uint8_t roles[INPUTS]; /* enum input_role and flags */
    uint8_t soft_limits[AXES][SOFT_LIMITS_BYTES]; /* the lowest and the highest position [steps], packed; each may be no limit */
#endif
};

enum { NO_LOWEST = INT32_MIN, NO_HIGHEST = INT32_MAX };
#define PACKED_NO_LIMITS {0, 0, 0, 0x80, 0xFF, 0xFF, 0xFF, 0x7F}

/* What holds as long as nothing is stored; in place, as a copy would take its room on the stack. */
static inline void settings_set_defaults(struct settings *settings)
{
    memset(settings, 0, sizeof *settings);
    settings->direction_setup_us = 30;
    settings->enable_lead_ms = 1;
    settings->enable_hold_ms = HOLD_FOR_EVER;
#if HAS_INPUTS
    settings->silence = USUAL_SILENCE;
    settings->looks = 4;
    for (uint8_t axis = 0; axis < AXES; axis++) {
        write_u32(settings->soft_limits[axis], (uint32_t)NO_LOWEST);
        write_u32(settings->soft_limits[axis] + 4, NO_HIGHEST);
    }
#endif
}

/* Checks packed settings. Returns the index of the first byte of the first setting that is out of its range, or
 * SETTINGS_BYTES when all are good. */
uint8_t settings_check(const uint8_t bytes[SETTINGS_BYTES]);

#if HAS_INPUTS && defined(ARDUINO)
/* The part of it that inputs have. */
uint8_t settings_check_inputs(const uint8_t *bytes);
#endif

/* Packed settings lie in the order of the struct and without gaps. Only their numbers may need to be turned round. Soft limits
 * are packed already, and left to others. */
static inline void settings_pack(const struct settings *settings, uint8_t bytes[SETTINGS_BYTES])
{
    memcpy(bytes, settings, SETTINGS_BYTES);
    if (!IS_LITTLE_ENDIAN) {
        write_u16(bytes + offsetof(struct settings, direction_setup_us), settings->direction_setup_us);
        write_u16(bytes + offsetof(struct settings, enable_lead_ms), settings->enable_lead_ms);
        write_u16(bytes + offsetof(struct settings, enable_hold_ms), settings->enable_hold_ms);
    }
}

static inline struct settings settings_unpack(const uint8_t bytes[SETTINGS_BYTES])
{
    struct settings settings;
    settings_set_defaults(&settings);
    memcpy(&settings, bytes, SETTINGS_BYTES);
    settings.direction_setup_us = read_u16(bytes + offsetof(struct settings, direction_setup_us));
    settings.enable_lead_ms = read_u16(bytes + offsetof(struct settings, enable_lead_ms));
    settings.enable_hold_ms = read_u16(bytes + offsetof(struct settings, enable_hold_ms));
    return settings;
}

#ifdef __cplusplus
}
#endif

#endif
