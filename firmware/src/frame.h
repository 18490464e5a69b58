/* Frames on the serial line: COBS( message, CRC-16 of the message ), then a zero byte. See docs/serial_protocol.md. */
#ifndef STEPRAMP_FRAME_H
#define STEPRAMP_FRAME_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    LONGEST_FRAME = 60,  /* [bytes], the zero byte that ends it included */
    CRC_BYTES = 2,
    LONGEST_MESSAGE = 56 /* [bytes]: a frame less COBS's code byte, the CRC and the zero byte */
};

#define CRC16_START 0xFFFFu

/* CRC-16/CCITT-FALSE continued by one byte; begins with CRC16_START. */
uint16_t crc16_update(uint16_t crc, uint8_t byte);

/* A frame as it arrives. All zero is a good beginning. */
struct frame_receiver {
    uint8_t bytes[LONGEST_MESSAGE + CRC_BYTES]; /* the message, decoded so far */
    uint8_t length;                             /* bytes decoded so far */
    uint8_t group_left;                         /* bytes still to come before COBS's next code byte */
    bool begun;                                 /* a byte of this frame has come */
    bool too_long;
    uint16_t crc; /* of all but the last two bytes decoded: those may be the frame's own CRC */
};

/* Takes one byte from the line. Returns the length of the message in `bytes` when it ends a good frame, else 0. */
uint8_t frame_receive(struct frame_receiver *receiver, uint8_t byte);

/* Makes a frame, in place, of the message that lies from frame[1] on. Returns the frame's length. */
uint8_t frame_encode(uint8_t frame[LONGEST_FRAME], uint8_t message_length);

#ifdef __cplusplus
}
#endif

#endif
