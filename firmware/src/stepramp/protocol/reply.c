#include "stepramp/protocol/reply.h"

#include <string.h>

#include "stepramp/edge/board.h"
#include "stepramp/protocol/frame.h"

static uint8_t reply[LONGEST_REPLY_BYTES + FRAME_EXTRA_BYTES], notice[LONGEST_NOTICE_BYTES + FRAME_EXTRA_BYTES];

/* Which of the two wait to be sent, a bit each, and which one the port has got last. */
enum { NEITHER = 0, REPLY = 1, NOTICE = 2 };
static uint8_t waiting, sent;

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

void notice_go_on(uint8_t length)
{
    next_field = notice + 1 + length;
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

static bool is_going_out(uint8_t which)
{
    return (waiting & which) != 0 || (sent == which && board_is_sending());
}

bool reply_is_going_out(void)
{
    return is_going_out(REPLY);
}

void notice_send(void)
{
    frame_encode(notice, (uint8_t)(next_field - notice - 1));
    waiting |= NOTICE;
}

bool notice_is_going_out(void)
{
    return is_going_out(NOTICE);
}

void notice_drop(void)
{
    waiting &= (uint8_t)~NOTICE;
}

void reply_send(void)
{
    waiting |= REPLY;
    reply_poll();
}

void reply_cut(void)
{
    waiting &= (uint8_t)~REPLY;
    sent = NEITHER;
    if (board_is_sending()) {
        board_cut_frame();
    }
}

void reply_poll(void)
{
    if (waiting == 0 || board_is_sending()) {
        return;
    }
    sent = (waiting & REPLY) != 0 ? REPLY : NOTICE;
    waiting ^= sent;
    board_send(sent == REPLY ? reply : notice);
}
