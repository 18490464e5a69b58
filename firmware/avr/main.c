/* The controller on an ATmega328P at 16 MHz (Arduino Uno, Nano). Where things are connected: pins.h. */
#include <avr/interrupt.h>
#include <avr/wdt.h>

#include "clock.h"
#include "controller.h"
#include "engine.h"
#include "port.h"
#include "serial.h"

/* A round takes as many bytes as a short request has; fewer while frames keep coming, as each takes time. */
enum { BYTES_AT_ONCE = 8, BYTES_IN_A_HURRY = 5 };

static void receive_bytes(uint8_t most)
{
    for (; most != 0 && port_has_received(); most--) {
        controller_receive(serial_take());
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
    bool has_time = true;
    for (;;) {
        wdt_reset();
        receive_bytes(has_time ? BYTES_AT_ONCE : BYTES_IN_A_HURRY);
        has_time = controller_poll();
    }
}
