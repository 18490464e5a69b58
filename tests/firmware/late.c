/* Beside the firmware, linked with --wrap=board_milliseconds: makes steps late. Each time that D9, D11 or D10 comes to ground,
 * all interrupts are blocked for 0.25, 0.5 or 1.6 ms. By D11 from right before an event of axis 0 or, where axis 2 moves as
 * well, of that one and, just behind it, of axis 0. */
#include <avr/io.h>
#include <util/atomic.h>
#include <util/delay.h>

#include "boards/avr/step_interrupt.h"
#include "stepramp/edge/step_rings.h"

enum { SHORT_PIN = 1 << 1, LONG_PIN = 1 << 2, MIDDLE_PIN = 1 << 3, PINS = SHORT_PIN | LONG_PIN | MIDDLE_PIN };

uint16_t __real_board_milliseconds(void);
uint16_t __wrap_board_milliseconds(void);

static int is_right_before_events(void)
{
    int16_t until = (int16_t)(OCR1A - TCNT1), gap = (int16_t)(stepramp_axis_players[0].due - OCR1A);
    uint8_t is_alone = (GPIOR0 & 1 << A_SHARED) == 0, is_second = (GPIOR0 & 1 << A_SECOND) != 0;
    return until > 0 && until < 400 && (is_alone || (is_second && gap > 200 && gap < 1500));
}

/* With interrupts off, which it lets in between two looks. */
static void wait_for_events(void)
{
    while (!is_right_before_events()) {
        sei();
        __asm__ volatile("nop\n nop\n");
        cli();
    }
}

uint16_t __wrap_board_milliseconds(void)
{
    static uint8_t was_low;
    uint8_t low = (uint8_t)~PINB & PINS, fell = low & (uint8_t)~was_low;
    was_low = low;
    PORTB |= PINS; /* pull-ups, which settings take away */
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        if ((fell & LONG_PIN) != 0) {
            _delay_us(1600);
        } else if ((fell & MIDDLE_PIN) != 0) {
            wait_for_events();
            _delay_us(500);
        } else if (fell != 0) {
            _delay_us(250);
        }
    }
    return __real_board_milliseconds();
}
