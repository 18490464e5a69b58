/* The serial port, 115200 baud. Bytes are received and sent by interrupts. */
#ifndef STEPRAMP_SERIAL_H
#define STEPRAMP_SERIAL_H

#define RECEIVED_BITS 5
#define RECEIVED_BYTES (1 << RECEIVED_BITS) /* room for what comes in 2.7 ms, and any request that comes while motors move */

/* UCSR0B while nothing is sent, and what is added to it while a frame goes out. */
#define RECEIVING (1 << RXCIE0 | 1 << RXEN0 | 1 << TXEN0)
#define SENDING (1 << UDRIE0)

#ifndef __ASSEMBLER__

#include <stdint.h>

void serial_begin(void);

/* Takes the oldest byte that was received; NO_BYTE when there is none. */
enum { NO_BYTE = -1 };
int16_t serial_take(void);

#endif

#endif
