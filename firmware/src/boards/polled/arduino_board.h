/* The port to Arduino boards: pins and a clock. For StepRamp.cpp and StepRampController.cpp. */
#ifndef STEPRAMP_ARDUINO_BOARD_H
#define STEPRAMP_ARDUINO_BOARD_H

#include <stdint.h>

#include "stepramp/edge/board_limits.h"

enum { GAUGES = 3, COIL_PINS = 4, NO_PIN = 255 };

/* Where everything is connected; NO_PIN: nowhere. */
struct arduino_pins {
    uint8_t step[AXES];
    uint8_t direction[AXES];
    uint8_t coils[GAUGES][COIL_PINS];
    uint8_t enable;
};

extern struct arduino_pins stepramp_pins;

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
