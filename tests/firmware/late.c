/* Beside the firmware, linked with --wrap=board_milliseconds: makes steps late. Each time that D9 or D10 comes to ground, all
 * interrupts are blocked for 0.25 or 1.6 ms. */
#include <avr/io.h>
#include <util/atomic.h>
#include <util/delay.h>

enum { SHORT_PIN = 1 << 1, LONG_PIN = 1 << 2 };

uint16_t __real_board_milliseconds(void);
uint16_t __wrap_board_milliseconds(void);

uint16_t __wrap_board_milliseconds(void)
{
    static uint8_t was_low;
    uint8_t low = (uint8_t)~PINB & (SHORT_PIN | LONG_PIN), fell = low & (uint8_t)~was_low;
    was_low = low;
    PORTB |= SHORT_PIN | LONG_PIN; /* pull-ups, which settings take away */
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE)
    {
        if ((fell & LONG_PIN) != 0) {
            _delay_us(1600);
        } else if (fell != 0) {
            _delay_us(250);
        }
    }
    return __real_board_milliseconds();
}
