/* The serial port, 115200 baud. Bytes are received by an interrupt, and sent when the main loop has the time. */
#ifndef STEPRAMP_SERIAL_H
#define STEPRAMP_SERIAL_H

#define RECEIVED_BYTES 64 /* a power of 2: room for what comes in 5.5 ms */

#ifndef __ASSEMBLER__

#include <stdbool.h>
#include <stdint.h>

void serial_begin(void);

/* Takes the oldest byte that was received. Returns false when there is none. */
bool serial_receive(uint8_t *byte);

/* The transmitter takes a byte now. */
bool serial_can_send(void);
void serial_send(uint8_t byte);

#endif

#endif
