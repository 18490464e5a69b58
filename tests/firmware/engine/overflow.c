/* Lets the stack grow, a little further in each round, as nothing in the firmware does, until the guard finds it out. Sends
 * each time why the processor began; the second time it ends. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <avr/wdt.h>
#include <util/delay.h>

#include "serial.h"
#include "stack_guard.h"
#include "stepramp/edge/board.h"

static void __attribute__((noinline)) grow(uint8_t deep)
{
    volatile uint8_t bytes[16];
    for (uint8_t i = 0; i < sizeof bytes; i++) {
        bytes[i] = deep;
    }
    if (deep != 0) {
        grow((uint8_t)(deep - 1));
    }
    bytes[0] = bytes[1];
}

int main(void)
{
    serial_begin();
    UDR0 = board_reset_cause();
    _delay_ms(1);
    if (board_reset_cause() != RESET_WATCHDOG) {
        wdt_enable(WDTO_15MS);
        stack_guard_begin();
        for (uint8_t deep = 1; deep != 0; deep++) {
            wdt_reset();
            grow(deep);
            stack_guard_check();
        }
        UDR0 = 0; /* not found out */
        _delay_ms(1);
        wdt_disable();
    }
    cli();
    sleep_enable();
    for (;;) {
        sleep_cpu();
    }
}
