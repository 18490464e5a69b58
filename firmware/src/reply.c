#include "reply.h"

#include <string.h>

#include "frame.h"

static uint8_t reply[LONGEST_REPLY_BYTES + FRAME_EXTRA_BYTES], notice[LONGEST_NOTICE_BYTES + FRAME_EXTRA_BYTES];

/* The next byte of each to send, counted from 1; 0: it has gone. A frame's last byte is its only zero. */
static uint8_t reply_at, notice_at;

/* Where the next field goes, of the one that is being written: its message begins at the frame's second byte. */
static uint8_t *next_field;

void reply_begin(const uint8_t request_header[MESSAGE_HEADER_BYTES])
{
    next_field = reply + 1;
    reply_bytes(request_header, MESSAGE_HEADER_BYTES);
    reply[1] |= KIND_REPLY;
    reply_u8(STATUS_OK);
}

void notice_begin(uint8_t kind, uint16_t session, uint8_t tag)
{
    next_field = notice + 1;
    reply_u8(kind);
    reply_u16(session);
    reply_u8(tag);
}

void reply_u8(uint8_t value)
{
    *next_field++ = value;
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

void reply_bytes(const uint8_t *bytes, uint8_t count)
{
    for (; count != 0; count--) {
        reply_u8(*bytes++);
    }
}

uint8_t *reply_reserved_byte(void)
{
    return next_field++;
}

void reply_numbers(const void *numbers, uint8_t count)
{
    const uint8_t *bytes = numbers;
    if (IS_LITTLE_ENDIAN) {
        reply_bytes(bytes, (uint8_t)(4 * count));
        return;
    }
    for (; count != 0; count--, bytes += 4) {
        uint32_t number;
        memcpy(&number, bytes, sizeof number);
        reply_u32(number);
    }
}

void reply_refusal(uint8_t status, uint16_t detail)
{
    next_field = reply + 1 + MESSAGE_HEADER_BYTES;
    reply_u8(status);
    reply_u16(detail);
}

void reply_status(uint8_t status, uint16_t detail)
{
    if (status != STATUS_OK) {
        reply_refusal(status, detail);
    }
}

void reply_end(void)
{
    frame_encode(reply, (uint8_t)(next_field - reply - 1));
}

void reply_send(void)
{
    reply_at = 1;
}

bool reply_is_going_out(void)
{
    return reply_at != 0;
}

void notice_send(void)
{
    frame_encode(notice, (uint8_t)(next_field - notice - 1));
    notice_at = 1;
}

bool notice_is_going_out(void)
{
    return notice_at != 0;
}

void notice_drop(void)
{
    if (notice_at == 1) {
        notice_at = 0;
    }
}

/* Takes the next byte of a frame. Returns false when it has gone. */
static bool take(const uint8_t *frame, uint8_t *at, uint8_t *byte)
{
    if (*at == 0) {
        return false;
    }
    *byte = frame[*at - 1];
    *at = *byte == 0 ? 0 : (uint8_t)(*at + 1);
    return true;
}

bool reply_next_byte(uint8_t *byte)
{
    if (notice_at > 1 || reply_at == 0) { /* a notice that has begun is not interrupted */
        return take(notice, &notice_at, byte);
    }
    return take(reply, &reply_at, byte);
}
