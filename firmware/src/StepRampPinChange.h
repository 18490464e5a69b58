/* The emergency stop of a sketch whose steps are made by a timer may be at any pin with a pin change interrupt. Include it in one
 * file of the sketch; see StepRamp.h. It takes the interrupts of pin changes, which SoftwareSerial, for one, wants as well. */
#ifndef STEPRAMP_PIN_CHANGE_H
#define STEPRAMP_PIN_CHANGE_H

#include <Arduino.h>
#include <avr/interrupt.h>

#include "boards/timer/timer_board.h"

#ifndef PCICR
#error "This board has no pin change interrupts."
#else

ISR(PCINT0_vect)
{
    stepramp_timer_look_at_stops();
}

#ifdef PCINT1_vect
ISR(PCINT1_vect)
{
    stepramp_timer_look_at_stops();
}

ISR(PCINT2_vect)
{
    stepramp_timer_look_at_stops();
}
#endif

/* The core's macros want a number that may be below 0. */
extern "C" bool arduino_watch_pin_change(uint8_t number)
{
    const int16_t pin = number;
    if (digitalPinToPCICR(pin) == nullptr) {
        return false;
    }
    *digitalPinToPCMSK(pin) |= (uint8_t)_BV(digitalPinToPCMSKbit(pin));
    *digitalPinToPCICR(pin) |= (uint8_t)_BV(digitalPinToPCICRbit(pin));
    return true;
}

#endif

#endif
