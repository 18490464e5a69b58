/* An emergency stop of a sketch that has chosen a timer: the interrupt of its pin ends the step interrupts. */
#include "boards/timer/timer_registers.h"

#ifdef STEPRAMP_HAS_TIMERS

#include <Arduino.h>

#include "boards/polled/arduino_board.h"
#include "boards/timer/timer_board.h"

#if HAS_INPUTS

/* Nobody makes a step any more from here on: of an interrupt that this one came in between, the pulse that it has begun is ended,
 * and engine.S looks at stepramp_emergency before it does more. */
void stepramp_timer_end_events(void)
{
    TIMSK1 = 0;
}

void stepramp_timer_look_at_stops(void)
{
    if (arduino_sees_stop()) {
        emergency_latch();
    }
}

bool stepramp_timer_watch_pin(uint8_t pin)
{
    if (digitalPinToInterrupt(pin) == NOT_AN_INTERRUPT) {
        return arduino_watch_pin_change(pin);
    }
    stepramp_attach_interrupt(digitalPinToInterrupt(pin), stepramp_timer_look_at_stops, CHANGE);
    return true;
}

#endif

#endif
