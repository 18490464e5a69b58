/* The pins of a sketch that has chosen a timer, and its clock. */
#include "boards/timer/timer_registers.h"

#ifdef STEPRAMP_HAS_TIMERS

#include <Arduino.h>
#include <util/atomic.h>

#include "boards/avr/step_interrupt.h"
#include "boards/polled/arduino_board.h"
#include "boards/timer/timer_board.h"
#include "boards/timer/timer_gauges.h"
#include "stepramp/edge/board.h"
#include "stepramp/store/driver_settings.h"

extern "C" {

/* In boards/avr/engine.S and line.S. All that the assembly names is defined there, so that the linker can leave it out. */
extern uint8_t stepramp_end_masks[AXES], stepramp_pulse_masks[AXES], stepramp_extra_width, stepramp_line_pulse_pins;

/* In timer_engine.S: PINx of each pin, and its bit. */
extern volatile uint8_t *stepramp_step_ports[AXES], *stepramp_turn_ports[AXES];
extern uint8_t stepramp_step_pins[AXES], stepramp_turn_pins[AXES];

/* Of Arduino's core, where it has the name that it has always had. */
extern volatile unsigned long timer0_overflow_count __attribute__((weak));

bool stepramp_has_coils;
const struct timer_gauges *stepramp_gauges;

}

namespace {

/* What the engine's own pulses have at least [cycles]; for the others see boards/avr/outputs.c. */
enum { OWN_PULSE_CYCLES = 40, WIDTH_CALL_CYCLES = 19, LISTENING_CALL_CYCLES = 33, WIDTH_UNIT_CYCLES = 8 };
enum { CYCLES_PER_US = F_CPU / 1000000 };

/* Longer waits have room for other interrupts. */
enum { LEAST_LISTENING_CYCLES = 8 * CYCLES_PER_US };

/* 64 us in microseconds and in Timer0's counts, as powers of 2 */
enum { US_BITS = 6, COUNT_BITS = 4 };

uint8_t both_edges; /* as configured; a bit for each axis */
uint8_t step_inverted;

/* Where there is no pin, a byte is moved that nobody looks at. */
volatile uint8_t *input_register(uint8_t pin)
{
    static volatile uint8_t nowhere;
    return pin == NO_PIN ? &nowhere : portInputRegister(digitalPinToPort(pin));
}

uint8_t bit_of(uint8_t pin)
{
    return pin == NO_PIN ? 1 : digitalPinToBitMask(pin);
}

void find_pins()
{
    for (uint8_t axis = 0; axis < AXES; axis++) {
        uint8_t step = stepramp_pins.step[axis], turn = stepramp_pins.direction[axis];
        stepramp_step_ports[axis] = input_register(step);
        stepramp_step_pins[axis] = bit_of(step);
        stepramp_turn_ports[axis] = input_register(turn);
        stepramp_turn_pins[axis] = bit_of(turn);
    }
}

/* Where each edge is a step, an edge less is a step less: such a pin keeps its level as long as it is one. */
void configure_axis(uint8_t axis, uint8_t bit, const struct settings *settings)
{
    uint8_t edges = settings->both_edges & bit, level = settings->step_inverted & bit;
    if ((edges & both_edges) == 0 || (step_inverted & bit) != level) {
        arduino_begin_pin(stepramp_pins.step[axis], level != 0);
    }
    arduino_begin_pin(stepramp_pins.direction[axis], (settings->direction_inverted & bit) == 0);
    stepramp_end_masks[axis] = 0;
    stepramp_pulse_masks[axis] = edges == 0 ? 0xFF : 0;
    stepramp_line_pulse_pins |= (uint8_t)(bit & ~edges);
}

void configure_width(uint8_t width_us)
{
    int16_t wait = (int16_t)(width_us * CYCLES_PER_US - OWN_PULSE_CYCLES);
    GPIOR0 = 0;
    if (wait > 0) {
        bool listens = wait >= LEAST_LISTENING_CYCLES;
        wait = (int16_t)(wait - (listens ? LISTENING_CALL_CYCLES : WIDTH_CALL_CYCLES));
        stepramp_extra_width = wait > 0 ? (uint8_t)((wait + WIDTH_UNIT_CYCLES - 1) / WIDTH_UNIT_CYCLES) : 1;
        GPIOR0 = listens ? _BV(WIDE) | _BV(LISTENS) : _BV(WIDE);
    }
}

} // namespace

void stepramp_timer_configure(const struct settings *settings)
{
    stepramp_timer_clear(0xFF);
    find_pins();
    arduino_begin_inputs(settings);
    if (stepramp_has_coils && settings->outputs != OUTPUTS_GAUGES) {
        stepramp_gauges->release();
    }
    stepramp_has_coils = stepramp_gauges != nullptr && settings->outputs == OUTPUTS_GAUGES;
    if (stepramp_has_coils) {
        arduino_use_enable_pin(false, false);
        GPIOR0 = _BV(OTHER_MODE);
        both_edges = 0;
        stepramp_gauges->configure();
        return;
    }
    stepramp_line_pulse_pins = 0;
    for (uint8_t axis = 0; axis < AXES; axis++) {
        configure_axis(axis, (uint8_t)(1 << axis), settings);
    }
    both_edges = settings->both_edges;
    step_inverted = settings->step_inverted;
    configure_width(settings->pulse_width_us);
    arduino_use_enable_pin(true, (settings->enable_flags & ENABLE_ACTIVE_HIGH) != 0);
}

void stepramp_timer_play_gauges(void)
{
    stepramp_gauges->play();
}

uint8_t stepramp_timer_step_mask(uint8_t axis)
{
    return stepramp_step_pins[axis];
}

uint8_t stepramp_timer_turn_mask(uint8_t axis)
{
    return stepramp_turn_pins[axis];
}

/* What micros() does, but in 16 bits: this is asked for several times in each round. Timer0 counts each 4 us. */
uint16_t stepramp_timer_time(void)
{
    if (&timer0_overflow_count == nullptr) {
        return (uint16_t)(micros() >> US_BITS);
    }
    uint16_t overflows;
    uint8_t count;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        overflows = (uint16_t)timer0_overflow_count;
        count = TCNT0;
        if ((TIFR0 & _BV(TOV0)) != 0 && count != UINT8_MAX) {
            overflows++;
        }
    }
    return (uint16_t)(overflows << (8 - COUNT_BITS) | count >> COUNT_BITS);
}

#endif
