/* The settings of a machine: what its motors' drivers want of the pins. Stored next to the ramps. */
#ifndef STEPRAMP_DRIVER_SETTINGS_H
#define STEPRAMP_DRIVER_SETTINGS_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "stepramp/protocol/message.h"

#ifdef __cplusplus
extern "C" {
#endif

enum outputs { OUTPUTS_STEP_AND_DIRECTION = 0, OUTPUTS_GAUGES = 1 };

enum { ENABLE_ACTIVE_HIGH = 1 };

enum { HOLD_FOR_EVER = 0xFFFF };

enum { SETTINGS_BYTES = 12 }; /* packed, as they travel and are stored */

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
};

/* What holds as long as nothing is stored. */
static inline struct settings settings_default(void)
{
    struct settings settings;
    memset(&settings, 0, sizeof settings);
    settings.direction_setup_us = 30;
    settings.enable_lead_ms = 1;
    settings.enable_hold_ms = HOLD_FOR_EVER;
    return settings;
}

/* Checks packed settings. Returns the index of the first byte of the first setting that is out of its range, or
 * SETTINGS_BYTES when all are good. */
uint8_t settings_check(const uint8_t bytes[SETTINGS_BYTES]);

/* Packed settings lie in the order of the struct and without gaps. Only their numbers may need to be turned round. */
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
