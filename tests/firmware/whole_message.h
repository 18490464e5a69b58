/* A whole message, put together from the bytes that frame_receive gives. */
#ifndef STEPRAMP_WHOLE_MESSAGE_H
#define STEPRAMP_WHOLE_MESSAGE_H

#include "stepramp/protocol/frame.h"

struct whole_message {
    struct frame_receiver receiver;
    uint8_t bytes[LONGEST_MESSAGE];
};

/* Takes a byte of the line. Returns the length of the message in `bytes` when it ends a good frame, else 0. */
static inline uint8_t message_receive(struct whole_message *message, uint8_t byte)
{
    uint16_t received = frame_receive(&message->receiver, byte);
    if ((uint8_t)received == FRAME_HAS_BYTE) {
        message->bytes[frame_byte_index(&message->receiver)] = (uint8_t)(received >> 8);
        return 0;
    }
    return (uint8_t)received;
}

#endif
