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

/* At start. */
void arduino_begin();

/* Plays the events that are due. Does nothing while it is at that already. */
void arduino_play();

/* By so much all motion is late [us]. */
uint32_t arduino_delayed_us();

#endif
