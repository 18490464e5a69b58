/* This machine as a board: pins are noted, time passes as the clock is looked at; what scenarios do with it. */
#ifndef BOARD_H
#define BOARD_H

#include <StepRampAxis.h>

#include <stdio.h>
#include <stdlib.h>

#define CHECK(condition)                                                                                               \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            printf("%s:%d: %s\n", __FILE__, __LINE__, #condition);                                                             \
            exit(1);                                                                                                   \
        }                                                                                                              \
    } while (false)

enum { PINS = 32, STEP = 2, DIRECTION = 5, ENABLE = 8, SLEW_US = 1000 };
enum { STOP_PIN = 20, FAULT_PIN = 21, LOW_SWITCH = 22, HIGH_SWITCH = 23, SECOND_SWITCH = 24 };

extern unsigned long now_us;
extern int level[PINS], edges[PINS];
extern bool is_output[PINS], is_pulled_up[PINS], is_grounded[PINS];
extern unsigned long rose_us[PINS], shortest_us[PINS], last_us[PINS], shortest_pulse_us;
extern uint8_t image[256];
extern uint16_t image_bytes;
extern int place, second_place; /* of the motors at STEP and behind it, by their pins */
extern unsigned long grounds_us; /* the emergency stop is pressed then */
extern int low_switch_at, high_switch_at, second_switch_at;
extern bool has_timer; /* for the choice of the clock: it plays nothing here */

/* With the ramp that is given: it has SLEW_US for slew interval, one axis or two. */
void begin();
void poll_for(unsigned long us);
void poll_until_rest();
void rest_at(StepRampAxis &axis, int32_t position);

#endif
