/* The port to Arduino boards: pins and a clock. For StepRamp.cpp and StepRampController.cpp. */
#ifndef STEPRAMP_ARDUINO_BOARD_H
#define STEPRAMP_ARDUINO_BOARD_H

#include <stdint.h>

#include "stepramp/edge/board_limits.h"
#include "stepramp/edge/inputs.h"
#include "stepramp/store/driver_settings.h"

enum { GAUGES = 3, COIL_PINS = 4, NO_PIN = 255 };

/* Where everything is connected; NO_PIN: nowhere. Nothing else than bytes, which arduino_pins_are_good() goes through: the coils are last,
 * as they may share pins with the others: a host chooses what the pins are. */
struct arduino_pins {
    uint8_t step[AXES];
    uint8_t direction[AXES];
    uint8_t enable;
    uint8_t inputs[INPUTS];
    uint8_t coils[GAUGES][COIL_PINS];
};

extern struct arduino_pins stepramp_pins;

/* What a sketch without a host has set. */
extern struct settings stepramp_sketch_settings;


/* A pin gets its level before it becomes an output. */
void arduino_begin_pin(uint8_t pin, bool high);

/* The enable pin from now on; with gauges it is left alone. */
void arduino_use_enable_pin(bool is_used, bool is_active_high);

extern "C" {

/* There may be gauges. What they take is left out of a sketch that doesn't call it. */
void arduino_use_gauges(void);

/* At start. */
void arduino_begin(void);

/* Steps are made by a timer's interrupt, which the sketch has chosen. */
bool arduino_has_timer(void);

/* The board has all pins, none is two things, and inputs are good. */
bool arduino_pins_are_good(void);

/* There are no more inputs than there may be. */
bool arduino_inputs_are_good(void);

/* The inputs' pins become what the settings say. */
void arduino_configure_inputs(const struct settings *settings);

/* The same, where there are inputs. */
static inline void arduino_begin_inputs(const struct settings *settings)
{
#if HAS_INPUTS
    if (has_inputs()) {
        WITH_INPUTS(arduino_configure_inputs)(settings);
    }
#else
    (void)settings;
#endif
}

/* An emergency stop's input is active, in as many looks in a row as the settings say; they are 4 us apart. */
bool arduino_sees_stop(void);

/* No axis has an event any more. Called with interrupts blocked. */
void arduino_end_events(void);

/* attachInterrupt of Arduino's core, once a sketch has handed it over. */
extern void (*stepramp_attach_interrupt)(uint8_t interrupt, void (*look)(void), int mode);

/* Has the pin's own interrupt look at the emergency stops, where a timer makes the steps and the pin has one. Returns false where it
 * has none: there poll() looks. */
bool arduino_watch_pin(uint8_t pin);

/* The same, by the interrupts that several pins share, where the sketch has chosen that (StepRampPinChange.h). */
bool arduino_watch_pin_change(uint8_t pin);

/* The coils' pins become outputs, with all gauges where they were. */
void arduino_begin_gauges(void);
void arduino_step_gauge(uint8_t gauge, bool is_backward);

/* And are let go of. */
void arduino_release_gauges(void);

/* Plays the events that are due. Does nothing while it is at that already. */
void arduino_play(void);

/* By so much all motion is late [us]. */
uint32_t arduino_delayed_us(void);

}

#endif
