/* The inputs: A0 to A5 are numbers 0 to 5, D9 to D11 6 to 8. */
#if defined(STEPRAMP_IN_ASSEMBLY)
#include "stepramp/edge/inputs.h"
#endif

#if defined(STEPRAMP_IN_ASSEMBLY) && HAS_INPUTS

#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/atomic.h>
#include <util/delay_basic.h>

#include "boards/avr/input_pins.h"
#include "boards/avr/pins.h"

/* Between two looks at the emergency stop, in loops of four cycles: with them 4 us. */
enum { LOOPS_BETWEEN_LOOKS = 14 };

volatile uint8_t stepramp_emergency;

static uint16_t used;        /* a bit for each input that has a role */
static uint16_t active_low;  /* of them */
static uint8_t stops;        /* of A0 to A5, those that are an emergency stop */
static uint8_t looks;

static inline bool is_pressed(void)
{
    return ((PINC ^ (uint8_t)active_low) & stops) != 0;
}

/* Nobody makes a step any more from here on: of an interrupt that this one came in between, the pulse that it has begun
 * is ended, and engine.S looks at stepramp_emergency before it does more. */
ISR(PCINT1_vect)
{
    uint8_t left = looks;
    while (is_pressed()) {
        if (--left == 0) {
            TIMSK1 = 0;
            stepramp_emergency = 1;
            return;
        }
        _delay_loop_2(LOOPS_BETWEEN_LOOKS);
    }
}

/* Pins of a port: outputs stay what they are. */
static void pull_up(volatile uint8_t *port, uint8_t mask, uint8_t pulled_up)
{
    *(port - (&PORTB - &DDRB)) &= (uint8_t)~mask;
    *port = (uint8_t)((*port & ~mask) | pulled_up);
}

void inputs_configure(const struct settings *settings, bool has_port_b)
{
    uint16_t bit = 1, pulled_up = 0;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        used = 0;
        active_low = 0;
        stops = 0;
        looks = settings->looks;
        for (uint8_t input = 0; input < INPUTS; input++, bit = (uint16_t)(bit << 1)) {
            uint8_t role = settings->roles[input];
            if ((role & ROLE_BITS) == ROLE_NONE || (input >= EMERGENCY_INPUTS && !has_port_b)) {
                continue;
            }
            used |= bit;
            active_low |= (role & INPUT_ACTIVE_HIGH) == 0 ? bit : 0;
            pulled_up |= (role & INPUT_WITHOUT_PULL_UP) == 0 ? bit : 0;
            stops |= (role & ROLE_BITS) == ROLE_EMERGENCY_STOP ? (uint8_t)bit : 0;
        }
        pull_up(&PORTC, (1 << EMERGENCY_INPUTS) - 1, (uint8_t)pulled_up & ((1 << EMERGENCY_INPUTS) - 1));
        if (has_port_b) {
            pull_up(&PORTB, INPUT_PINS_B, (uint8_t)(pulled_up >> EMERGENCY_INPUTS << FIRST_INPUT_BIT_B));
        }
        PCMSK1 = stops;
        PCICR = stops != 0 ? _BV(PCIE1) : 0;
    }
}

uint16_t inputs_read(void)
{
    uint8_t b = (uint8_t)((PINB & INPUT_PINS_B) >> FIRST_INPUT_BIT_B);
    uint16_t levels = (uint16_t)((PINC & ((1 << EMERGENCY_INPUTS) - 1)) | (uint16_t)b << EMERGENCY_INPUTS);
    return (levels ^ active_low) & used;
}

bool emergency_is_latched(void)
{
    return stepramp_emergency != 0;
}

void emergency_latch(void)
{
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        TIMSK1 = 0;
        stepramp_emergency = 1;
    }
}

void emergency_release(void)
{
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        if (!is_pressed()) {
            stepramp_emergency = 0;
        }
    }
}

#endif
