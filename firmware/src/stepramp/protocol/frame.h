/* Frames on the serial line: COBS( message, CRC-16 of the message ), then a zero byte. See docs/serial_protocol.md. */
#ifndef STEPRAMP_FRAME_H
#define STEPRAMP_FRAME_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    LONGEST_FRAME = 60, /* [bytes], the zero byte that ends it included */
    CRC_BYTES = 2,
    FRAME_EXTRA_BYTES = CRC_BYTES + 2,                  /* of a frame: COBS's code byte, the CRC and the zero byte */
    LONGEST_MESSAGE = LONGEST_FRAME - FRAME_EXTRA_BYTES /* [bytes] */
};

#define CRC16_START 0xFFFFu

/* CRC-16/CCITT-FALSE continued by one byte; begins with CRC16_START. */
uint16_t frame_crc16_update(uint16_t crc, uint8_t byte);

/* The CRC of some bytes. */
uint16_t frame_crc16(const uint8_t *bytes, uint16_t count);

/* A frame as it arrives. It gives the bytes of the message one by one, so that none of them needs a place that doesn't
 * have one yet. All zero is a good beginning. */
struct frame_receiver {
    uint8_t tail[CRC_BYTES]; /* what has been decoded last: may be the frame's own CRC */
    uint8_t count;           /* bytes received, COBS's first code byte included; 0: the frame has not begun */
    uint8_t group_left;      /* bytes still to come before COBS's next code byte */
    uint16_t crc;            /* of the message so far */
};

enum { FRAME_GOES_ON = 0, FRAME_STOPS = 0xFE, FRAME_HAS_BYTE = 0xFF };

/* Takes one byte from the line. Returns, in its lower byte, FRAME_HAS_BYTE when it gives one more byte of the message, which
 * is the upper one, the length of the message when it ends a good frame, or FRAME_GOES_ON. A damaged frame may give bytes,
 * but no length. FRAME_STOPS: it was HALT_BYTE or STOP_BYTE twice, which is the upper byte. */
uint16_t frame_receive(struct frame_receiver *receiver, uint8_t byte);

/* The byte's place in the message, after FRAME_HAS_BYTE. */
static inline uint8_t frame_byte_index(const struct frame_receiver *receiver)
{
    return (uint8_t)(receiver->count - (CRC_BYTES + 2));
}

/* Makes a frame, in place, of the message that lies from frame[1] on. Returns the frame's length. */
uint8_t frame_encode(uint8_t *frame, uint8_t message_length);

#ifdef __cplusplus
}
#endif

#endif
