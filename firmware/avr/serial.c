#include "serial.h"

#include <avr/io.h>

#define BAUD 115200ul

/* In receive.S */
extern volatile uint8_t received_in, received_out;
extern volatile uint8_t received[RECEIVED_BYTES];

void serial_begin(void)
{
    UCSR0A = _BV(U2X0);
    UBRR0 = (F_CPU + BAUD * 4) / (BAUD * 8) - 1;
    UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
    UCSR0B = _BV(RXCIE0) | _BV(RXEN0) | _BV(TXEN0);
}

bool serial_receive(uint8_t *byte)
{
    uint8_t out = received_out;
    if (out == received_in) {
        return false;
    }
    *byte = received[out];
    received_out = (uint8_t)((out + 1) & (RECEIVED_BYTES - 1));
    return true;
}

bool serial_can_send(void)
{
    return (UCSR0A & _BV(UDRE0)) != 0;
}

void serial_send(uint8_t byte)
{
    UDR0 = byte;
}
