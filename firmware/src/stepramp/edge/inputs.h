/* A machine's inputs, where a build has them: what a board gives. An input is a bit by its number; what it is for, and which
 * level is its active one, its role says (driver_settings.h). */
#ifndef STEPRAMP_INPUTS_H
#define STEPRAMP_INPUTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "stepramp/edge/build_options.h"

#ifdef __cplusplus
extern "C" {
#endif

/* So many inputs there are, and the first of them can be emergency stops. */
enum { INPUTS = 9, EMERGENCY_INPUTS = 6 };

#if HAS_INPUTS

#ifdef ARDUINO
struct settings; /* driver_settings.h */
struct feed;     /* feed.h */

/* A sketch reaches what has to do with inputs through this table, so that the linker leaves it out of one that has none. */
struct inputs_functions {
    uint8_t (*machine_check_ways)(uint8_t mask, const int32_t *values, bool is_run, uint16_t *detail);
    uint8_t (*machine_check_part)(uint8_t axis, bool backward, uint32_t steps, uint16_t *detail);
    void (*machine_end_run)(struct feed *feed, bool backward);
    void (*machine_forget_fast)(uint8_t mask);
    void (*machine_inputs_configure)(void);
    void (*machine_watch_inputs)(uint16_t now_ms);
    uint16_t (*machine_active_inputs)(void);
    uint8_t (*machine_stopped_by)(void);
    bool (*machine_acknowledge)(void);
    bool (*machine_is_in_emergency)(void);
    uint8_t (*machine_new_stop)(const uint8_t *before, const uint8_t *roles);
    void (*emergency_release)(void);
    uint8_t (*settings_check_inputs)(const uint8_t *bytes);
    bool (*arduino_inputs_are_good)(void);
    void (*arduino_configure_inputs)(const struct settings *settings);
    bool (*arduino_sees_stop)(void);
};
extern const struct inputs_functions *stepramp_inputs; /* NULL as long as it has asked for none */

/* The same of homing: a sketch may have inputs without. */
struct homing_functions {
    uint8_t (*homing_begin)(uint8_t axes, int32_t *intervals, uint32_t slow_interval, uint16_t steps_back, uint16_t *detail);
    void (*homing_end)(uint8_t axes);
    void (*homing_go_on)(void);
};
extern const struct homing_functions *stepramp_homing;

#define WITH_INPUTS(function) (stepramp_inputs->function)
#define WITH_HOMING(function) (stepramp_homing->function)
#define IN_TABLE
static inline bool has_inputs(void)
{
    return stepramp_inputs != NULL;
}
static inline bool has_homing(void)
{
    return stepramp_homing != NULL;
}
#else
#define WITH_INPUTS(function) function
#define WITH_HOMING(function) function
#define IN_TABLE static /* nobody calls it from elsewhere */
static inline bool has_inputs(void)
{
    return true;
}
static inline bool has_homing(void)
{
    return true;
}
#endif

/* The inputs that are at their active levels at this moment. */
uint16_t inputs_read(void);

/* The emergency stop: once it is latched no axis has an event, and none is started, until it is released. A board latches it in the
 * interrupt of an input's edge. What was queued and played stays readable, as after a halt. */
bool emergency_is_latched(void);
void emergency_latch(void);

/* Does nothing while an emergency stop's input is active. */
void emergency_release(void);

#else

static inline bool has_inputs(void)
{
    return false;
}

#endif

#ifdef __cplusplus
}
#endif

#endif
