/* Enables the motors, then hangs until the watchdog interrupts it, and then resets the processor. Sends each time why the processor began. The
 * second time it raises a pin for 100 ms by its clock, and ends. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <util/delay.h>

#include "clock.h"
#include "reset.h"
#include "serial.h"
#include "stepramp/edge/board.h"
#include "stepramp/edge/step_queue.h"
#include "stepramp/store/driver_settings.h"

static void wait_until(uint16_t ms)
{
    while (board_milliseconds() != ms) {
    }
}

int main(void)
{
    struct settings settings;
    settings_set_defaults(&settings);
    settings.enable_flags = ENABLE_ACTIVE_HIGH;
    clock_begin();
    serial_begin();
    step_queue_begin();
    board_configure(&settings);
    UDR0 = board_reset_cause();
    _delay_ms(1);
    if (board_reset_cause() != RESET_WATCHDOG) {
        board_enable(true);
        watchdog_begin();
        sei();
        for (;;) {
        }
    }
    DDRC = _BV(0);
    wait_until(20);
    PORTC = _BV(0);
    wait_until(120);
    PORTC = 0;
    cli();
    sleep_enable();
    for (;;) { /* a byte that comes may wake it once more */
        sleep_cpu();
    }
}
