#include "serial.h"

#include <avr/io.h>
#include <util/atomic.h>

#include "port.h"

#define BAUD 115200ul

/* In usart.S */
extern volatile uint8_t received_in, received_out, serial_control;
extern volatile uint8_t received[RECEIVED_BYTES];
extern const uint8_t *serial_next;

/* While nothing is being sent: the interrupts leave it as it is then. */
static void set_control(uint8_t control)
{
    serial_control = control;
    UCSR0B = control;
}

void serial_begin(void)
{
    UCSR0A = _BV(U2X0);
    UBRR0 = (F_CPU + BAUD * 4) / (BAUD * 8) - 1;
    UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
    set_control(RECEIVING);
}

uint8_t serial_take(void)
{
    uint8_t out = received_out;
    uint8_t byte = received[out];
    received_out = (uint8_t)((out + 1) & (RECEIVED_BYTES - 1));
    return byte;
}

bool port_has_received(void)
{
    return received_out != received_in;
}

bool port_is_sending(void)
{
    return (serial_control & SENDING) != 0;
}

void port_send(const uint8_t *frame)
{
    serial_next = frame;
    set_control(RECEIVING | SENDING);
}

void port_cut_frame(void)
{
    static const uint8_t end = 0;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { serial_next = &end; }
}
