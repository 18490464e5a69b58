#include "board.h"

unsigned long now_us;
int level[PINS], edges[PINS];
bool is_output[PINS], is_pulled_up[PINS], is_grounded[PINS];
unsigned long rose_us[PINS], shortest_us[PINS], last_us[PINS], shortest_pulse_us;
uint8_t image[256];
uint16_t image_bytes;
int place, second_place; /* of the motors at STEP and behind it, by their pins */
unsigned long grounds_us = ULONG_MAX; /* the emergency stop is pressed then */
int low_switch_at = -1000000, high_switch_at = 1000000, second_switch_at = 1000000;
bool has_timer; /* for the choice of the clock: it plays nothing here */

/* ---- the Arduino API ---- */

/* 32 bits, as on every board: they come round after 71.6 minutes, those of millis() after 49.7 days. */
unsigned long micros()
{
    is_grounded[STOP_PIN] |= now_us == grounds_us;
    return (uint32_t)++now_us;
}

unsigned long millis()
{
    return (uint32_t)(now_us / 1000);
}

void delayMicroseconds(unsigned int microseconds)
{
    now_us += microseconds;
}

void pinMode(uint8_t pin, uint8_t mode)
{
    is_output[pin] = mode == OUTPUT;
    is_pulled_up[pin] = mode == INPUT_PULLUP;
}

/* A pin that nothing drives is high by its pull-up, or low. */
int digitalRead(uint8_t pin)
{
    bool is_switched = (pin == LOW_SWITCH && place <= low_switch_at) || (pin == HIGH_SWITCH && place >= high_switch_at) ||
                       (pin == SECOND_SWITCH && second_place >= second_switch_at);
    return is_pulled_up[pin] && !is_grounded[pin] && !is_switched ? HIGH : LOW;
}

void digitalWrite(uint8_t pin, uint8_t value)
{
    if (level[pin] == value) {
        return;
    }
    level[pin] = value;
    edges[pin] += is_output[pin];
    if (!is_output[pin]) {
        return;
    }
    if (value == HIGH) {
        unsigned long since_us = now_us - rose_us[pin];
        last_us[pin] = since_us;
        shortest_us[pin] = shortest_us[pin] == 0 || since_us < shortest_us[pin] ? since_us : shortest_us[pin];
        rose_us[pin] = now_us;
        place += pin != STEP ? 0 : level[DIRECTION] == HIGH ? 1 : -1;
        second_place += pin != STEP + 1 ? 0 : level[DIRECTION + 1] == HIGH ? 1 : -1;
    } else if (pin == STEP && (shortest_pulse_us == 0 || now_us - rose_us[pin] < shortest_pulse_us)) {
        shortest_pulse_us = now_us - rose_us[pin];
    }
}

int Print::availableForWrite()
{
    return 0;
}

extern "C" bool __wrap_arduino_has_timer()
{
    return has_timer;
}

/* ---- what scenarios do ---- */

void begin()
{
    StepRamp.setStepper(0, STEP, DIRECTION);
    StepRamp.setStepper(1, STEP + 1, DIRECTION + 1);
    StepRamp.setEnablePin(ENABLE);
    CHECK(StepRamp.begin(image, image_bytes));
}

void poll_for(unsigned long us)
{
    for (unsigned long end = now_us + us; now_us < end;) {
        StepRamp.poll();
    }
}

void poll_until_rest()
{
    for (unsigned long end = now_us + 60000000; StepRamp.isMoving();) {
        CHECK(now_us < end);
        StepRamp.poll();
    }
}

void rest_at(StepRampAxis &axis, int32_t position)
{
    CHECK(axis.moveTo(position) == STEPRAMP_OK);
    poll_until_rest();
    CHECK(axis.position() == position);
}
