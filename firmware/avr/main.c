/* The controller on an ATmega328P at 16 MHz (Arduino Uno, Nano). Where things are connected: pins.h. */
#include <avr/interrupt.h>
#include <avr/wdt.h>

#include "clock.h"
#include "controller.h"
#include "engine.h"
#include "serial.h"

/* Moves at most one byte in and one out. */
static void move_bytes(void)
{
    uint8_t byte;
    if (serial_receive(&byte)) {
        controller_receive(byte);
    }
    if (serial_can_send() && controller_next_byte(&byte)) {
        serial_send(byte);
    }
}

int main(void)
{
    wdt_enable(WDTO_250MS);
    clock_begin();
    engine_begin();
    serial_begin();
    controller_begin();
    sei();
    for (;;) {
        wdt_reset();
        move_bytes();
        controller_poll();
    }
}
