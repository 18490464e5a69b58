#ifdef STEPRAMP_IN_ASSEMBLY

#include "boards/avr/gauge.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/pgmspace.h>
#include <util/atomic.h>

#include "boards/avr/enable_pin.h"
#include "boards/avr/pins.h"
#include "stepramp/edge/board.h"
#include "stepramp/edge/inputs.h"
#include "stepramp/edge/play_event.h"

#ifndef STEPRAMP_IN_A_SKETCH

/* One turn of the rotor's magnet has six states; these are their coils, the first pin in bit 0. */
enum { STATES = 6 };
static const uint8_t state_pins[STATES] PROGMEM = {0x9, 0x1, 0x7, 0x6, 0xE, 0x8};

/* Where each gauge is. It outlives a reset by the watchdog, so that no needle jumps then. */
static uint8_t states[GAUGES] __attribute__((section(".noinit")));

#else

/* In arduino_board.cpp */
void arduino_begin_gauges(void);
void arduino_step_gauge(uint8_t gauge, bool is_backward);

#endif

static uint8_t backward; /* a bit for each gauge */
static volatile uint8_t running;

#ifndef STEPRAMP_IN_A_SKETCH

/* Puts all coils to their states. D2..D13 are twelve bits in a row over two ports. Both ports change within half a
 * microsecond, which is nothing to a coil. */
static void write_coils(void)
{
    uint16_t coils = 0;
    for (uint8_t gauge = GAUGES; gauge-- > 0;) {
        coils = (uint16_t)(coils << 4 | pgm_read_byte(&state_pins[states[gauge]]));
    }
    PORTD = (uint8_t)((PORTD & ~GAUGE_PINS_D) | (uint8_t)(coils << 2));
    PORTB = (uint8_t)((PORTB & ~GAUGE_PINS_B) | (uint8_t)(coils >> 6));
}

void gauges_configure(void)
{
    static bool were_configured;
    bool are_known = were_configured || (board_reset_cause() & RESET_WATCHDOG) != 0;
    were_configured = true;
    for (uint8_t gauge = 0; gauge < GAUGES; gauge++) {
        if (states[gauge] >= STATES || !are_known) {
            states[gauge] = 0;
        }
    }
    backward = 0;
    write_coils();
    DDRD |= GAUGE_PINS_D;
    DDRB |= GAUGE_PINS_B;
}

#else

static void write_coils(void)
{
}

void gauges_configure(void)
{
    backward = 0;
    arduino_begin_gauges();
}

#endif

/* Returns false when it is parked from now on. */
static bool play_gauge(uint8_t gauge, uint8_t bit, uint16_t now)
{
    uint8_t result = play_event(&stepramp_axis_players[gauge], stepramp_queues[gauge], now);
    if ((result & EVENT_STEP) != 0) {
#ifdef STEPRAMP_IN_A_SKETCH
        arduino_step_gauge(gauge, (backward & bit) != 0);
#else
        uint8_t state = (uint8_t)(states[gauge] + ((backward & bit) != 0 ? STATES - 1 : 1));
        states[gauge] = (uint8_t)(state < STATES ? state : state - STATES);
#endif
    }
    if ((result & EVENT_TURN) != 0) {
        backward ^= bit;
    }
    return (result & EVENT_PARKED) == 0;
}

/* Plays what is due, and sets the compare register to what comes next. Returns false when that is past already. */
static bool play_due_gauges(void)
{
    uint16_t now = TCNT1;
    int16_t wait = LONGEST_WAIT_TICKS;
    uint8_t bit = 1;
    for (uint8_t gauge = 0; gauge < GAUGES; gauge++, bit = (uint8_t)(bit << 1)) {
        const struct axis_player *player = &stepramp_axis_players[gauge];
        if ((running & bit) != 0 && (int16_t)(player->due - now) <= 0 && !play_gauge(gauge, bit, now)) {
            running &= (uint8_t)~bit;
        }
        int16_t until = (int16_t)(player->due - now);
        if ((running & bit) != 0 && until < wait) {
            wait = until;
        }
    }
    write_coils();
    OCR1B = (uint16_t)(now + (uint16_t)wait);
    TIFR1 = _BV(OCF1B);
    return (int16_t)((uint16_t)(now + (uint16_t)wait) - TCNT1) > 0;
}

#ifdef STEPRAMP_IN_A_SKETCH
/* See timer_gauges.c. */
static void play_gauges(void)
#else
/* The step interrupt jumps here; the name pleases the compiler. */
ISR(__vector_gauges)
#endif
{
    while (running != 0 && !play_due_gauges()) {
    }
    if (running == 0) {
        TIMSK1 = 0;
    }
}

void gauges_start(uint8_t axes, uint16_t delay_ticks)
{
    axes &= _BV(GAUGES) - 1;
    if (axes == 0) {
        return;
    }
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        uint16_t start = (uint16_t)(TCNT1 + delay_ticks);
        struct axis_player *player = stepramp_axis_players;
        for (uint8_t left = axes; left != 0; left >>= 1, player++) {
            if ((left & 1) != 0) {
                player->due = start;
            }
        }
        if (running == 0 || (int16_t)(start - OCR1B) < 0) {
            OCR1B = start;
        }
        if (running == 0) {
            TIFR1 = _BV(OCF1B);
        }
        running |= axes;
#if HAS_INPUTS
        TIMSK1 = emergency_is_latched() ? 0 : _BV(OCIE1B);
#else
        TIMSK1 = _BV(OCIE1B);
#endif
    }
}

void gauges_halt(uint8_t axes)
{
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { running &= (uint8_t)~axes; }
}

uint8_t gauges_running(void)
{
    return running;
}

#endif
