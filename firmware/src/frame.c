#include "frame.h"

uint16_t crc16_update(uint16_t crc, uint8_t byte)
{
    /* Eight shifts of the polynomial x^16 + x^12 + x^5 + 1 at once: its three terms give the three xors. */
    uint8_t high = (uint8_t)((crc >> 8) ^ byte);
    high ^= high >> 4;
    return (uint16_t)((crc << 8) ^ ((uint16_t)high << 12) ^ ((uint16_t)high << 5) ^ high);
}

/* Adds a decoded byte. The CRC is kept up as bytes arrive, so that the end of a frame costs no more than any byte. */
static void append(struct frame_receiver *receiver, uint8_t byte)
{
    if (receiver->length == sizeof receiver->bytes) {
        receiver->too_long = true;
        return;
    }
    if (receiver->length >= CRC_BYTES) {
        receiver->crc = crc16_update(receiver->crc, receiver->bytes[receiver->length - CRC_BYTES]);
    }
    receiver->bytes[receiver->length++] = byte;
}

/* Returns the length of the message if what has been received is a whole and undamaged one, else 0. */
static uint8_t finished_length(const struct frame_receiver *receiver)
{
    uint8_t length = receiver->length;
    if (receiver->too_long || receiver->group_left != 0 || length <= CRC_BYTES) {
        return 0;
    }
    uint16_t sent = (uint16_t)(receiver->bytes[length - 2] | (uint16_t)receiver->bytes[length - 1] << 8);
    return sent == receiver->crc ? (uint8_t)(length - CRC_BYTES) : 0;
}

uint8_t frame_receive(struct frame_receiver *receiver, uint8_t byte)
{
    if (byte == 0) {
        uint8_t length = receiver->begun ? finished_length(receiver) : 0;
        receiver->begun = false;
        return length;
    }
    if (!receiver->begun) {
        receiver->begun = true;
        receiver->too_long = false;
        receiver->length = 0;
        receiver->crc = CRC16_START;
        receiver->group_left = (uint8_t)(byte - 1);
    } else if (receiver->group_left == 0) {
        append(receiver, 0); /* a code byte stands for the zero before its group */
        receiver->group_left = (uint8_t)(byte - 1);
    } else {
        append(receiver, byte);
        receiver->group_left--;
    }
    return 0;
}

uint8_t frame_encode(uint8_t frame[LONGEST_FRAME], uint8_t message_length)
{
    uint16_t crc = CRC16_START;
    for (uint8_t i = 1; i <= message_length; i++) {
        crc = crc16_update(crc, frame[i]);
    }
    uint8_t end = (uint8_t)(message_length + CRC_BYTES + 1);
    frame[end - 2] = (uint8_t)crc;
    frame[end - 1] = (uint8_t)(crc >> 8);
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
