#include "serial.h"

#include <avr/io.h>
#include <util/atomic.h>

#include "stepramp/edge/board.h"
#include "stepramp/protocol/message.h"

#define BAUD 115200ul

/* In usart.S */
extern volatile uint8_t serial_received_in, serial_received_out, serial_control;
extern volatile uint8_t serial_received[RECEIVED_BYTES];
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

static uint8_t wrapped(uint8_t number)
{
    return number & (RECEIVED_BYTES - 1);
}

int16_t serial_take(void)
{
    uint8_t out = serial_received_out;
    if (out == serial_received_in) {
        return NO_BYTE;
    }
    uint8_t byte = serial_received[wrapped(out)];
    serial_received_out = (uint8_t)(out + 1);
    return byte;
}

/* Looks back from the end: what was taken last is still there. Behind another stop it waits for its turn. One that has been
 * found is not looked for again, as long as nothing comes in and nothing is taken. */
bool board_skip_to_stop(void)
{
    static uint8_t found_in, found_unread;
    uint8_t in = serial_received_in, unread = (uint8_t)(in - serial_received_out), begin = 0, kind = 0, code = 0;
    if (in == found_in && unread == found_unread) {
        return unread != 0;
    }
    if (unread == 0 || serial_received[wrapped(in - 1)] != 0) {
        return false;
    }
    for (uint8_t back = 2; back != RECEIVED_BYTES; back++) {
        uint8_t byte = serial_received[wrapped(in - back)];
        if (byte == 0 && is_urgent(kind)) {
            if (begin != 0 || unread < back) {
                return true; /* or it is what is taken next */
            }
            begin = back;
        } else if (byte == 0 && begin == 0) {
            return false; /* it ends with another frame, or an empty one */
        }
        kind = code;
        code = byte;
    }
    if (begin != 0) {
        serial_received_out = (uint8_t)(in - begin);
        found_in = in;
        found_unread = begin;
    }
    return begin != 0;
}

bool board_has_received(void)
{
    return serial_received_out != serial_received_in;
}

bool board_is_sending(void)
{
    return (serial_control & SENDING) != 0;
}

void board_send(const uint8_t *frame)
{
    serial_next = frame;
    set_control(RECEIVING | SENDING);
}

void board_cut_frame(void)
{
    static uint8_t end; /* 0 */
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { serial_next = &end; }
}
