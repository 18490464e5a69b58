#include "stepramp/protocol/frame.h"

#include <stdbool.h>

#include "stepramp/protocol/message.h"

#ifndef STEPRAMP_IN_ASSEMBLY

/* Counts in a receiver: of a frame whose message is empty, or as long as it may be. */
enum { EMPTY_COUNT = 1 + CRC_BYTES, LONGEST_COUNT = 1 + LONGEST_MESSAGE + CRC_BYTES };

uint16_t frame_crc16_update(uint16_t crc, uint8_t byte)
{
    /* Eight shifts of the polynomial x^16 + x^12 + x^5 + 1 at once: its three terms give the three xors. In bytes, as an
     * AVR shifts a wider number bit by bit. */
    uint8_t high = (uint8_t)((crc >> 8) ^ byte);
    high ^= high >> 4;
    uint8_t next_high = (uint8_t)((uint8_t)crc ^ (uint8_t)(high << 4) ^ high >> 3);
    uint8_t next_low = (uint8_t)(high ^ high << 5);
    return (uint16_t)(next_high << 8 | next_low);
}

/* The length of the message if what has been received is a whole and undamaged one, else 0. */
static uint8_t finished_length(const struct frame_receiver *receiver)
{
    uint8_t length = (uint8_t)(receiver->count - EMPTY_COUNT);
    bool is_whole = length <= LONGEST_MESSAGE && receiver->group_left == 0;
    return is_whole && read_u16(receiver->tail) == receiver->crc ? length : 0;
}

uint16_t frame_receive(struct frame_receiver *receiver, uint8_t byte)
{
    if (byte == 0) {
        uint8_t last = receiver->tail[1];
        bool stops = receiver->count == 2 && last >= HALT_BYTE && receiver->group_left == last - 2;
        uint8_t length = finished_length(receiver);
        receiver->count = 0;
        receiver->group_left = 0;
        return stops ? (uint16_t)(last << 8 | FRAME_STOPS) : length;
    }
    uint8_t count = receiver->count;
    if (receiver->group_left-- == 0) {
        receiver->group_left = (uint8_t)(byte - 1);
        byte = 0; /* a code byte stands for the zero before its group, but the first one for nothing */
        if (count == 0) {
            receiver->crc = CRC16_START;
            receiver->count = 1;
            return FRAME_GOES_ON;
        }
    }
    uint8_t decoded = receiver->tail[0];
    receiver->tail[0] = receiver->tail[1];
    receiver->tail[1] = byte;
    if (count > LONGEST_COUNT) { /* it is too long, and stays so */
        return FRAME_GOES_ON;
    }
    receiver->count = (uint8_t)(count + 1);
    if (count < EMPTY_COUNT || count == LONGEST_COUNT) {
        return FRAME_GOES_ON;
    }
    /* The CRC is kept up as bytes arrive, so that the end of a frame costs no more than any byte. */
    receiver->crc = frame_crc16_update(receiver->crc, decoded);
    return (uint16_t)(decoded << 8 | FRAME_HAS_BYTE);
}

#endif

uint16_t frame_crc16(const uint8_t *bytes, uint16_t count)
{
    uint16_t crc = CRC16_START;
    for (; count != 0; count--) {
        crc = frame_crc16_update(crc, *bytes++);
    }
    return crc;
}

uint8_t frame_encode(uint8_t *frame, uint8_t message_length)
{
    uint8_t end = (uint8_t)(1 + message_length);
    write_u16(frame + end, frame_crc16(frame + 1, message_length));
    end = (uint8_t)(end + CRC_BYTES);
    /* Each zero, and the place before the first byte, takes the distance to the next zero. No frame is long enough for
     * COBS's groups of 254 bytes. */
    uint8_t code_at = 0;
    for (uint8_t i = 1; i < end; i++) {
        if (frame[i] == 0) {
            frame[code_at] = (uint8_t)(i - code_at);
            code_at = i;
        }
    }
    frame[code_at] = (uint8_t)(end - code_at);
    frame[end] = 0;
    return (uint8_t)(end + 1);
}
