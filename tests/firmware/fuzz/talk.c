#include "talk.h"

#include <stdbool.h>
#include <string.h>

#include "chance.h"
#include "model.h"
#include "must.h"
#include "protocol_port.h"
#include "stepramp/protocol/controller.h"
#include "stepramp/protocol/message.h"
#include "stepramp/protocol/reply.h"
#include "stepramp/store/eeprom_slots.h"
#include "whole_message.h"

enum { MOST_ROUNDS = 4000, MOST_ROUNDS_OF_AN_ANSWER = 5000 };

static struct whole_message as_received; /* what the controller makes of the bytes sent */
static uint8_t last_header[MESSAGE_HEADER_BYTES];
static uint8_t last_reply[LONGEST_MESSAGE];
static uint8_t last_reply_length;
uint16_t session;
long counts[256], accepted[256];

static bool is_notice(uint8_t kind)
{
    return kind == KIND_REPORT_NOTICE || kind == KIND_TRACE_NOTICE;
}

/* A stop or halt has come: what is being sent may end early. */
static bool may_be_cut;

/* Gives the next byte that is sent, until all frames have gone. */
static bool is_sent(uint8_t *byte)
{
    reply_poll();
    return port_next_byte(byte);
}

/* Takes what the controller sends. Returns the length of the reply, 0 when there is none. */
static uint8_t hear(uint8_t reply[LONGEST_MESSAGE])
{
    static struct whole_message message;
    uint8_t byte, reply_length = 0;
    while (is_sent(&byte)) {
        uint8_t length = message_receive(&message, byte);
        must(byte != 0 || length >= MESSAGE_HEADER_BYTES || may_be_cut, "it sent a bad frame");
        may_be_cut = may_be_cut && byte != 0;
        if (length != 0 && !is_notice(message.bytes[0])) {
            must(reply_length == 0, "two replies");
            memcpy(reply, message.bytes, length);
            reply_length = length;
        }
    }
    return reply_length;
}

static bool is_repeat(const uint8_t *message)
{
    bool is_done_each_time = message[0] == KIND_HELLO || message[0] == KIND_STOP || message[0] == KIND_HALT;
    return memcmp(message, last_header, sizeof last_header) == 0 && !is_done_each_time;
}

static void note_reply(const uint8_t *message, uint8_t length, const uint8_t *reply, uint8_t reply_length)
{
    must(reply_length > MESSAGE_HEADER_BYTES && reply[0] == (message[0] | KIND_REPLY) &&
             memcmp(reply + 1, message + 1, MESSAGE_HEADER_BYTES - 1) == 0,
         "a reply to another request");
    if (is_repeat(message)) {
        must(reply_length == last_reply_length && memcmp(reply, last_reply, reply_length) == 0, "another reply");
        return;
    }
    memcpy(last_header, message, sizeof last_header);
    memcpy(last_reply, reply, reply_length);
    last_reply_length = reply_length;
    counts[message[0]]++;
    bool is_accepted = reply[MESSAGE_HEADER_BYTES] == STATUS_OK;
    bool writes_anew = is_accepted && (message[0] == KIND_COMMIT || message[0] == KIND_ROLL_BACK);
    if (model.is_writing && (!eeprom_slots_are_writing() || writes_anew)) {
        model_note_written(); /* while the request waited */
    }
    if (is_accepted) {
        accepted[message[0]]++;
        session = message[0] == KIND_HELLO ? read_u16(message + 1) : session;
        model_note_accepted(message, length);
    }
    model_note_dropped_delivery();
}

static uint8_t await_reply(uint8_t reply[LONGEST_MESSAGE])
{
    uint8_t length = 0;
    for (unsigned rounds = 0; length == 0 && rounds < MOST_ROUNDS_OF_AN_ANSWER; rounds++) {
        port_round();
        length = hear(reply);
    }
    return length;
}

/* What stops in place of a frame is answered as a request without a session and a tag. */
static void hear_stop_answered(uint8_t byte)
{
    uint8_t reply[LONGEST_MESSAGE];
    may_be_cut = true;
    uint8_t length = await_reply(reply);
    must(length == MESSAGE_HEADER_BYTES + 1, "a byte that stops isn't answered");
    must(reply[0] == (KIND_REPLY | (byte == STOP_BYTE ? KIND_STOP : KIND_HALT)), "and not as a stop is");
    memset(last_header, 0, sizeof last_header);
}

void talk_send(const uint8_t *bytes, size_t count)
{
    static unsigned of_frame; /* bytes so far */
    static uint8_t first, last;
    uint8_t reply[LONGEST_MESSAGE];
    for (size_t i = 0; i < count; i++) {
        bool stops = bytes[i] == 0 && of_frame == 2 && first >= HALT_BYTE && last == first;
        first = of_frame == 0 ? bytes[i] : first;
        last = bytes[i];
        of_frame = bytes[i] == 0 ? 0 : of_frame + 1;
        uint8_t length = message_receive(&as_received, bytes[i]);
        controller_receive(bytes[i]);
        if (stops) {
            hear_stop_answered(first);
            continue;
        }
        if (length >= MESSAGE_HEADER_BYTES) {
            may_be_cut = as_received.bytes[0] == KIND_STOP || as_received.bytes[0] == KIND_HALT;
            uint8_t reply_length = await_reply(reply);
            if (is_notice(as_received.bytes[0] | KIND_REPLY)) { /* an unknown kind, whose answer looks like a notice */
                memcpy(last_header, as_received.bytes, sizeof last_header);
                continue;
            }
            must(reply_length != 0, "no answer");
            note_reply(as_received.bytes, length, reply, reply_length);
        }
    }
}

void talk_let_time_pass(void)
{
    uint32_t rounds = one_in(16) ? below(MOST_ROUNDS) : one_in(8) ? below(50) : below(3);
    uint8_t reply[LONGEST_MESSAGE];
    for (; rounds != 0; rounds--) {
        port_round();
        must(hear(reply) == 0, "a reply to nothing");
    }
}
