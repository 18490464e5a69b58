/* The controller on an ATmega328P at 16 MHz (Arduino Uno, Nano). Where things are connected: pins.h. */
#include <avr/interrupt.h>
#include <avr/wdt.h>

#include "clock.h"
#include "reset.h"
#include "serial.h"
#include "stack_guard.h"
#include "stepramp/edge/board.h"
#include "stepramp/edge/step_queue.h"
#include "stepramp/protocol/controller.h"

/* A round takes so many bytes: a stop that is skipped to, and few enough to leave time for motors when frames keep coming. */
enum { BYTES_A_ROUND = 10 };

static void receive_bytes(void)
{
    int16_t byte;
    for (uint8_t left = BYTES_A_ROUND; left != 0 && (byte = serial_take()) != NO_BYTE; left--) {
        controller_receive((uint8_t)byte);
    }
}

int main(void)
{
    watchdog_begin();
    stack_guard_begin();
    clock_begin();
    step_queue_begin();
    serial_begin();
    controller_begin();
    sei();
    for (;;) {
        wdt_reset();
        stack_guard_check();
        board_skip_to_stop();
        receive_bytes();
        if (board_skip_to_stop()) { /* it has come in the meantime */
            receive_bytes();
        }
        controller_poll();
    }
}
