/* The inputs of a sketch, at pins that it names. */
#include <Arduino.h>

#include "boards/polled/arduino_board.h"
#include "boards/polled/replaceable.h"

#if HAS_INPUTS

#ifdef __AVR__
#include <util/atomic.h>
#define UNDISTURBED ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
#else
#define UNDISTURBED /* no interrupt has to do with any of it */
#endif

extern "C" {
const struct inputs_functions *stepramp_inputs;
const struct homing_functions *stepramp_homing;
void (*stepramp_attach_interrupt)(uint8_t interrupt, void (*look)(void), int mode);
extern volatile uint8_t stepramp_emergency;
volatile uint8_t stepramp_emergency; /* the step interrupts look at it, where a timer has them */
}

namespace {

/* Between two looks at an emergency stop [us]; what a look takes comes to it. */
enum { BETWEEN_LOOKS_US = 3 };

uint16_t used;       /* a bit for each input that has a role */
uint16_t active_low; /* of them */
uint8_t looks;

/* A pin, as quickly as it can be read. */
struct stop_pin {
#ifdef __AVR__
    volatile uint8_t *port;
    uint8_t bit;
#else
    uint8_t pin;
#endif
    bool is_active_low;
};

stop_pin stops[EMERGENCY_INPUTS];
uint8_t stop_count;

stop_pin stop_at(uint8_t pin, bool is_active_low)
{
#ifdef __AVR__
    return {portInputRegister(digitalPinToPort(pin)), digitalPinToBitMask(pin), is_active_low};
#else
    return {pin, is_active_low};
#endif
}

bool is_pressed(const stop_pin &stop)
{
#ifdef __AVR__
    bool is_high = (*stop.port & stop.bit) != 0;
#else
    bool is_high = digitalRead(stop.pin) == HIGH;
#endif
    return is_high != stop.is_active_low;
}

bool is_any_pressed()
{
    for (uint8_t i = 0; i < stop_count; i++) {
        if (is_pressed(stops[i])) {
            return true;
        }
    }
    return false;
}

uint16_t bit_of(uint8_t input)
{
    return (uint16_t)(1u << input);
}

void configure_input(uint8_t input, uint8_t role)
{
    uint8_t pin = stepramp_pins.inputs[input];
    bool is_active_low = (role & INPUT_ACTIVE_HIGH) == 0;
    used |= bit_of(input);
    active_low |= is_active_low ? bit_of(input) : 0;
    if (pin == NO_PIN) {
        return;
    }
    pinMode(pin, (role & INPUT_WITHOUT_PULL_UP) == 0 ? INPUT_PULLUP : INPUT);
    if ((role & ROLE_BITS) == ROLE_EMERGENCY_STOP) {
        stops[stop_count++] = stop_at(pin, is_active_low);
        arduino_watch_pin(pin);
    }
}

} // namespace

REPLACEABLE bool arduino_watch_pin_change(uint8_t pin)
{
    (void)pin;
    return false;
}

void arduino_configure_inputs(const struct settings *settings)
{
    UNDISTURBED
    {
        stop_count = 0;
        used = 0;
        active_low = 0;
        looks = settings->looks;
        for (uint8_t input = 0; input < INPUTS; input++) {
            if ((settings->roles[input] & ROLE_BITS) != ROLE_NONE) {
                configure_input(input, settings->roles[input]);
            }
        }
    }
}

bool arduino_sees_stop(void)
{
    for (uint8_t left = looks; is_any_pressed(); delayMicroseconds(BETWEEN_LOOKS_US)) {
        if (--left == 0) {
            return true;
        }
    }
    return false;
}

/* ---- inputs.h ---- */

/* A role without a pin counts as active: what it is to stop doesn't move. */
uint16_t inputs_read(void)
{
    uint16_t active = 0;
    for (uint8_t input = 0; input < INPUTS; input++) {
        uint16_t bit = bit_of(input);
        uint8_t pin = stepramp_pins.inputs[input];
        if ((used & bit) != 0 && (pin == NO_PIN || (digitalRead(pin) == LOW) == ((active_low & bit) != 0))) {
            active |= bit;
        }
    }
    return active;
}

bool emergency_is_latched(void)
{
    return stepramp_emergency != 0;
}

void emergency_latch(void)
{
    UNDISTURBED
    {
        arduino_end_events();
        stepramp_emergency = 1;
    }
}

void emergency_release(void)
{
    UNDISTURBED
    {
        if (!is_any_pressed()) {
            stepramp_emergency = 0;
        }
    }
}

#endif
