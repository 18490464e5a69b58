/* The controller on an ATmega328P at 16 MHz (Arduino Uno, Nano): step on D2, direction on D3, serial port on D0 and D1.
 *
 * The step interrupt is the only interrupt, so that nothing delays a step; the serial port and the EEPROM are polled
 * (docs/decisions/0003-polled-serial-port.md). */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/delay.h>

#include "controller.h"
#include "limits.h"
#include "player.h"
#include "port.h"

#define STEP_PIN PD2
#define DIRECTION_PIN PD3

/* From the direction to the first pulse [ticks]; 60 = 30 us. At least 20 us are promised. */
#define DIRECTION_SETUP_TICKS 60u

#define BAUD 115200ul

/* Timer1 counts up at 2 MHz and is never written: an event is so many ticks after the last, however late that was. */
static void timer_begin(void)
{
    TCCR1A = 0;
    TCCR1B = _BV(CS11);
}

/* The time is past: true when it came before what Timer1 counts now, of the 2^16 ticks around it. */
static inline bool is_past(uint16_t time)
{
    return (int16_t)(TCNT1 - time) > 0;
}

/* The step interrupt. A pulse begins always the same time after the compare match. Should the time of the next event be
 * past when it is set, its compare match may have been missed: then it is served at once. */
ISR(TIMER1_COMPA_vect)
{
    uint16_t next;
    do {
        TIFR1 = _BV(OCF1A);
        if (player_pulse_is_due()) {
            PORTD |= _BV(STEP_PIN);
        }
        uint16_t ticks = player_event();
        PORTD &= (uint8_t)~_BV(STEP_PIN);
        if (ticks == 0) {
            TIMSK1 = 0;
            return;
        }
        next = OCR1A + ticks;
        OCR1A = next;
    } while (is_past(next));
}

void port_start_events(bool forward)
{
    __asm__ volatile("" ::: "memory"); /* all that the interrupt reads is written by now */
    if (forward) {
        PORTD |= _BV(DIRECTION_PIN);
    } else {
        PORTD &= (uint8_t)~_BV(DIRECTION_PIN);
    }
    OCR1A = TCNT1 + DIRECTION_SETUP_TICKS;
    TIFR1 = _BV(OCF1A);
    TIMSK1 = _BV(OCIE1A);
}

void port_stop_events(void)
{
    TIMSK1 = 0;
}

uint8_t port_eeprom_read(uint16_t address)
{
    while (port_eeprom_is_busy()) {
    }
    EEAR = address;
    EECR |= _BV(EERE);
    return EEDR;
}

/* The two bits must be set within four cycles; no interrupt comes, since no event does (port.h). */
void port_eeprom_write(uint16_t address, uint8_t value)
{
    EEAR = address;
    EEDR = value;
    EECR = _BV(EEMPE);
    EECR |= _BV(EEPE);
}

bool port_eeprom_is_busy(void)
{
    return (EECR & _BV(EEPE)) != 0;
}

static void serial_begin(void)
{
    UCSR0A = _BV(U2X0);
    UBRR0 = (F_CPU + BAUD * 4) / (BAUD * 8) - 1;
    UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
    UCSR0B = _BV(RXEN0) | _BV(TXEN0);
}

/* Moves at most one byte in and one out. */
static void serial_poll(void)
{
    if ((UCSR0A & _BV(RXC0)) != 0) {
        controller_receive(UDR0);
    }
    uint8_t byte;
    if ((UCSR0A & _BV(UDRE0)) != 0 && controller_next_byte(&byte)) {
        UDR0 = byte;
    }
}

int main(void)
{
    DDRD = _BV(STEP_PIN) | _BV(DIRECTION_PIN);
    timer_begin();
    serial_begin();
    controller_begin();
    sei();
    for (;;) {
        serial_poll();
        controller_poll();
    }
}
