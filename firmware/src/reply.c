#include "reply.h"

#include "frame.h"

static uint8_t frame[LONGEST_FRAME]; /* kept until the next reply, so that a repeated request gets it again */
static uint8_t message_length;
static uint8_t frame_length;
static uint8_t sent;

void reply_begin(uint8_t request_kind, uint16_t session, uint8_t tag)
{
    message_length = 0;
    reply_u8(request_kind | KIND_REPLY);
    reply_u16(session);
    reply_u8(tag);
}

void reply_u8(uint8_t value)
{
    frame[1 + message_length++] = value;
}

void reply_u16(uint16_t value)
{
    reply_u8((uint8_t)value);
    reply_u8((uint8_t)(value >> 8));
}

void reply_u32(uint32_t value)
{
    reply_u16((uint16_t)value);
    reply_u16((uint16_t)(value >> 16));
}

void reply_ok(void)
{
    reply_u8(STATUS_OK);
}

void reply_refusal(enum status status, uint16_t detail)
{
    reply_u8((uint8_t)status);
    reply_u16(detail);
}

void reply_end(void)
{
    frame_length = frame_encode(frame, message_length);
    sent = frame_length;
}

void reply_send(void)
{
    sent = 0;
}

bool reply_is_going_out(void)
{
    return sent != frame_length;
}

bool reply_next_byte(uint8_t *byte)
{
    if (!reply_is_going_out()) {
        return false;
    }
    *byte = frame[sent++];
    return true;
}
