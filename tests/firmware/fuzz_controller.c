/* Sends frames to the controller, most of them wrong in some way, and watches what it does.
 *
 * usage: fuzz_controller FRAMES SEED IMAGE...   the ramp images in hexadecimal
 *
 * Ends with 0 when all was well, and prints what has been reached. All of it follows from the seed. What must hold:
 *
 *  - a good hello is always answered, soon;
 *  - the ramp in use is one that was stored, or tried, whole; the stored one and the one before it too;
 *  - the positions change only by the steps that the pins show, and by set_position and zero;
 *  - the settings in use are allowed ones;
 *  - a request that comes twice gets the same reply. */
#define _POSIX_C_SOURCE 200809L /* alarm */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "controller.h"
#include "limits.h"
#include "machine.h"
#include "message.h"
#include "protocol_port.h"
#include "ramp_store.h"
#include "reply.h"
#include "settings.h"
#include "slots.h"
#include "whole_message.h"

enum { MOST_IMAGES = 16, LONGEST_BURST = 512, LONGEST_BODY = LONGEST_MESSAGE - MESSAGE_HEADER_BYTES };
enum { HELLO_EVERY = 256, MOST_ROUNDS = 4000, MOST_ROUNDS_OF_AN_ANSWER = 5000, HANG_SECONDS = 30, ALARM_EVERY = 10000 };

struct image {
    uint16_t length; /* 0: none */
    uint8_t bytes[LARGEST_IMAGE_BYTES];
};

static struct image images[MOST_IMAGES];
static unsigned image_count;
static long frame_number;
static long counts[256], accepted[256];

static void fail(const char *what)
{
    fprintf(stderr, "frame %ld: %s\n", frame_number, what);
    abort();
}

static void must(bool holds, const char *what)
{
    if (!holds) {
        fail(what);
    }
}

/* ---- chance ---- */

static uint64_t chance_state;

static uint32_t chance(void)
{
    chance_state = chance_state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(chance_state >> 32);
}

static uint32_t below(uint32_t bound)
{
    return chance() % bound;
}

static bool one_in(uint32_t n)
{
    return below(n) == 0;
}

/* Numbers that have a meaning more often than others. */
static uint32_t some_number(void)
{
    static const uint32_t marked[] = {0, 1, 2, 0x7FFF, 0x8000, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x0FFFFFFF};
    switch (below(4)) {
    case 0:
        return marked[below(sizeof marked / sizeof marked[0])];
    case 1:
        return chance();
    case 2:
        return below(2000);
    default:
        return 0u - below(2000);
    }
}

/* ---- what the controller must hold ---- */

static struct {
    struct image delivery; /* what has been accepted of it */
    uint16_t announced_crc;
    uint16_t announced;
    bool is_delivered_to, is_checked, settings_on_trial;
    struct image on_trial, stored, previous;
    struct image being_stored;
    bool is_writing;
    uint32_t zero[PORT_AXES]; /* position less steps */
} model;

static uint16_t crc_of(const uint8_t *bytes, uint16_t length)
{
    uint16_t crc = CRC16_START;
    for (uint16_t i = 0; i < length; i++) {
        crc = crc16_update(crc, bytes[i]);
    }
    return crc;
}

static const struct image *image_in_use(void)
{
    return model.on_trial.length != 0 ? &model.on_trial : &model.stored;
}

static void check_images(void)
{
    const struct image *used = image_in_use();
    must(ramp_store_crc() == (used->length ? crc_of(used->bytes, used->length) : 0), "another ramp is in use");
    must(ramp_store_axes() == (used->length ? used->bytes[2] : 0), "another number of axes");
    if (machine_axes() != 0) {
        must(ramp_store_ram_length() == used->length, "a ramp of another length");
        for (uint16_t i = 0; i < used->length; i++) {
            must(slot_content.image[i] == used->bytes[i], "another ramp is played");
        }
    }
    must(slots_image_length(ACTIVE_SLOT) == model.stored.length, "another ramp is stored");
    must(slots_image_length(PREVIOUS_SLOT) == model.previous.length, "another ramp was stored before");
}

/* Costs more time: not after each frame. */
static void check_slots(void)
{
    for (uint16_t i = 0; i < model.stored.length; i++) {
        must(slots_read(ACTIVE_SLOT, i) == model.stored.bytes[i], "the stored ramp has changed");
    }
    for (uint16_t i = 0; i < model.previous.length; i++) {
        must(slots_read(PREVIOUS_SLOT, i) == model.previous.bytes[i], "the previous ramp has changed");
    }
}

static void check_positions(void)
{
    for (uint8_t i = 0; i < PORT_AXES; i++) {
        uint32_t position = (uint32_t)machine_report(i).position;
        must(position == model.zero[i] + (uint32_t)port_steps[i], "a position isn't that of the motor");
    }
}

static void note_written(void)
{
    model.is_writing = false;
    model.previous = model.stored;
    model.stored = model.being_stored;
    model.on_trial.length = 0;
    model.is_delivered_to = false;
    model.is_checked = false;
    model.settings_on_trial = false;
}

static void finish_writing(void)
{
    for (long rounds = 0; slots_are_writing(); rounds++) {
        must(rounds < 100000, "writing doesn't end");
        port_round();
    }
    must((ramp_store_flags() & FLAG_WRITE_FAILED) == 0, "writing has failed");
    note_written();
    check_images();
    check_slots();
}

static void check_all(void)
{
    if (model.is_writing && (!slots_are_writing() || one_in(8))) {
        finish_writing();
    }
    must(settings_check(ramp_store_settings()) == SETTINGS_BYTES, "the settings are bad");
    check_positions();
    if (!slots_are_writing()) {
        check_images();
    }
}

/* ---- what an accepted request does to it ---- */

static void has_begun(const uint8_t *body)
{
    model.announced = read_u16(body);
    model.announced_crc = read_u16(body + 2);
    model.delivery.length = 0;
    model.is_delivered_to = true;
    model.is_checked = false;
    model.on_trial.length = 0;
}

static void has_taken_data(const uint8_t *body, uint8_t length)
{
    uint8_t count = (uint8_t)(length - 2);
    must(model.is_delivered_to && read_u16(body) == model.delivery.length, "data at a wrong offset was taken");
    must(model.delivery.length + count <= model.announced, "too much data was taken");
    memcpy(model.delivery.bytes + model.delivery.length, body + 2, count);
    model.delivery.length = (uint16_t)(model.delivery.length + count);
    model.is_checked = false;
}

static void has_ended(void)
{
    must(model.is_delivered_to && model.delivery.length == model.announced, "a part of a ramp was taken");
    must(crc_of(model.delivery.bytes, model.announced) == model.announced_crc, "a damaged ramp was taken");
    model.is_checked = true;
}

static void has_been_tried(void)
{
    must(model.is_checked, "what wasn't checked is on trial");
    model.on_trial = model.delivery;
    model.is_delivered_to = false;
    model.is_checked = false;
}

static void has_begun_to_store(void)
{
    must(model.is_checked || (!model.is_delivered_to && image_in_use()->length != 0), "nothing is stored");
    model.being_stored = model.is_checked ? model.delivery : *image_in_use();
    model.is_writing = true;
}

static void has_rolled_back(void)
{
    if (model.is_delivered_to || model.on_trial.length != 0 || model.settings_on_trial) {
        model.is_delivered_to = false;
        model.is_checked = false;
        model.on_trial.length = 0;
        model.settings_on_trial = false;
        return;
    }
    must(model.previous.length != 0, "rolled back to nothing");
    model.being_stored = model.previous;
    model.is_writing = true;
}

/* A request that needs the ramp in use drops a delivery, also when it is refused then for another reason. */
static void may_have_dropped_the_delivery(void)
{
    if (model.is_delivered_to && !ramp_store_is_delivered_to()) {
        must(model.stored.length != 0, "a delivery was dropped for nothing");
        model.is_delivered_to = false;
        model.is_checked = false;
    }
}

/* At rest: no step has been made since. */
static void have_new_positions(uint8_t kind, const uint8_t *body)
{
    uint8_t axes = *body++;
    for (uint8_t i = 0; i < PORT_AXES; i++) {
        if ((axes >> i & 1) != 0) {
            uint32_t position = kind == KIND_ZERO ? read_u16(body) : read_u32(body);
            model.zero[i] = position - (uint32_t)port_steps[i];
            body += kind == KIND_ZERO ? 0 : 4;
        }
    }
}

static void note_accepted(const uint8_t *message, uint8_t length)
{
    const uint8_t *body = message + MESSAGE_HEADER_BYTES;
    switch (message[0]) {
    case KIND_BEGIN:
        has_begun(body);
        break;
    case KIND_DATA:
        has_taken_data(body, (uint8_t)(length - MESSAGE_HEADER_BYTES));
        break;
    case KIND_END:
        has_ended();
        break;
    case KIND_TRY:
        has_been_tried();
        break;
    case KIND_COMMIT:
        has_begun_to_store();
        break;
    case KIND_ROLL_BACK:
        has_rolled_back();
        break;
    case KIND_WRITE_SETTINGS:
        model.settings_on_trial = true;
        break;
    case KIND_SET_POSITION:
    case KIND_ZERO:
        have_new_positions(message[0], body);
        break;
    default:
        break;
    }
}

/* ---- sending and listening ---- */

static struct whole_message as_received; /* what the controller makes of the bytes sent */
static uint8_t last_header[MESSAGE_HEADER_BYTES];
static uint8_t last_reply[LONGEST_MESSAGE];
static uint8_t last_reply_length;
static uint16_t session;

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
    if (model.is_writing && (!slots_are_writing() || writes_anew)) {
        note_written(); /* while the request waited */
    }
    if (is_accepted) {
        accepted[message[0]]++;
        session = message[0] == KIND_HELLO ? read_u16(message + 1) : session;
        note_accepted(message, length);
    }
    may_have_dropped_the_delivery();
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

/* Sends bytes, and looks at the answer to each good frame among them. */
static void send(const uint8_t *bytes, size_t count)
{
    uint8_t reply[LONGEST_MESSAGE];
    for (size_t i = 0; i < count; i++) {
        uint8_t length = message_receive(&as_received, bytes[i]);
        controller_receive(bytes[i]);
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

static void let_time_pass(void)
{
    uint32_t rounds = one_in(16) ? below(MOST_ROUNDS) : one_in(8) ? below(50) : below(3);
    uint8_t reply[LONGEST_MESSAGE];
    for (; rounds != 0; rounds--) {
        port_round();
        must(hear(reply) == 0, "a reply to nothing");
    }
}

/* ---- making requests ---- */

static struct image delivered; /* the image being delivered */
static uint8_t tag;

static uint8_t put_u16(uint8_t *body, uint8_t at, uint32_t value)
{
    body[at] = (uint8_t)value;
    body[at + 1] = (uint8_t)(value >> 8);
    return (uint8_t)(at + 2);
}

static uint8_t put_u32(uint8_t *body, uint8_t at, uint32_t value)
{
    return put_u16(body, put_u16(body, at, value), value >> 16);
}

/* Some images are damaged, but have a good CRC. */
static uint8_t make_begin(uint8_t *body)
{
    delivered = images[below(image_count)];
    for (uint32_t changes = one_in(4) ? 1 + below(4) : 0; changes != 0; changes--) {
        delivered.bytes[below(delivered.length)] = (uint8_t)chance();
    }
    uint16_t crc = crc_of(delivered.bytes, delivered.length);
    put_u16(body, 0, one_in(50) ? some_number() : delivered.length);
    return put_u16(body, 2, one_in(50) ? some_number() : crc);
}

static uint8_t make_data(uint8_t *body)
{
    uint16_t offset = model.delivery.length < delivered.length ? model.delivery.length : 0;
    uint16_t left = (uint16_t)(delivered.length - offset);
    uint8_t count = (uint8_t)(left < MOST_DATA_BYTES ? left : MOST_DATA_BYTES);
    count = one_in(10) && count > 1 ? (uint8_t)(1 + below(count)) : count;
    put_u16(body, 0, one_in(50) ? some_number() : offset);
    memcpy(body + 2, delivered.bytes + offset, count);
    return (uint8_t)(2 + count);
}

static uint8_t make_settings(uint8_t *body)
{
    struct settings settings = {(uint8_t)one_in(8), (uint8_t)below(16), (uint8_t)below(16), (uint8_t)below(16),
                                (uint8_t)below(2),  (uint8_t)below(5),  (uint16_t)(20 + below(100)),
                                (uint16_t)below(4), (uint16_t)below(5)};
    settings_pack(&settings, body);
    if (one_in(4)) {
        body[below(SETTINGS_BYTES)] = (uint8_t)chance();
    }
    return SETTINGS_BYTES;
}

/* An interval that is often one that the ramp allows. */
static uint32_t some_interval(void)
{
    uint32_t interval = one_in(4) ? some_number() : 200 + below(one_in(2) ? 3000 : 100000);
    return one_in(2) ? interval : 0u - interval;
}

static uint8_t make_for_axes(uint8_t kind, uint8_t *body)
{
    uint8_t at = 1;
    body[0] = (uint8_t)(one_in(20) ? chance() : 1 + below(15) % ((1u << (ramp_store_axes() | 1)) - 1));
    if (kind == KIND_ZERO) {
        return put_u16(body, at, below(3000));
    }
    if (kind == KIND_LINE) {
        body[at++] = (uint8_t)below(5);
    }
    for (uint8_t i = 0; i < 8; i++) {
        if ((body[0] >> i & 1) != 0) {
            at = put_u32(body, at, kind == KIND_RUN ? some_interval() : some_number());
        }
    }
    return at;
}

static uint8_t make_body(uint8_t kind, uint8_t *body)
{
    switch (kind) {
    case KIND_HELLO:
        body[0] = one_in(20) ? (uint8_t)chance() : PROTOCOL_VERSION;
        return 1;
    case KIND_STATUS:
        body[0] = (uint8_t)below(5);
        return 1;
    case KIND_REPORT:
        body[0] = (uint8_t)below(60);
        return 1;
    case KIND_TRACE:
        body[0] = one_in(4) ? TRACE_OFF : (uint8_t)below(5);
        return put_u16(body, 1, one_in(4) ? some_number() : below(20));
    case KIND_BEGIN:
        return make_begin(body);
    case KIND_DATA:
        return make_data(body);
    case KIND_READ:
        body[0] = (uint8_t)below(4);
        put_u16(body, 1, one_in(4) ? some_number() : below(500));
        body[3] = (uint8_t)below(50);
        return 4;
    case KIND_WRITE_SETTINGS:
        return make_settings(body);
    case KIND_STOP:
    case KIND_HALT:
        body[0] = (uint8_t)below(17);
        return (uint8_t)below(2);
    default:
        return kind >= KIND_MOVE_BY && kind <= KIND_ZERO ? make_for_axes(kind, body) : 0;
    }
}

/* What brings a delivery to its end. */
static uint8_t next_of_delivery(void)
{
    if (model.is_checked) {
        return one_in(3) ? KIND_COMMIT : KIND_TRY;
    }
    if (model.delivery.length == model.announced) {
        return one_in(10) ? KIND_BEGIN : KIND_END;
    }
    return model.delivery.length < delivered.length ? KIND_DATA : KIND_BEGIN;
}

static uint8_t some_kind(void)
{
    static const uint8_t kinds[] = {
        KIND_HELLO,         KIND_STATUS,  KIND_STATUS,  KIND_REPORT,  KIND_TRACE,     KIND_TRACE,        KIND_BEGIN,
        KIND_BEGIN,         KIND_END,     KIND_COMMIT,  KIND_READ,    KIND_READ,      KIND_TRY,          KIND_ROLL_BACK,
        KIND_READ_SETTINGS, KIND_MOVE_BY, KIND_MOVE_BY, KIND_MOVE_TO, KIND_RUN,       KIND_SET_POSITION, KIND_ZERO,
        KIND_LINE,          KIND_LINE,    KIND_STOP,    KIND_HALT,    KIND_HALT,      KIND_WRITE_SETTINGS};
    if (model.is_delivered_to && !one_in(20)) {
        return next_of_delivery();
    }
    return one_in(100) ? (uint8_t)chance() : kinds[below(sizeof kinds)];
}

/* Makes a frame of a request. Returns its length. */
static uint8_t make_frame(uint8_t frame[LONGEST_FRAME])
{
    uint8_t *message = frame + 1;
    message[0] = some_kind();
    uint16_t its_session = one_in(50) ? (uint16_t)some_number() : session;
    if (message[0] == KIND_HELLO && one_in(2)) {
        its_session = (uint16_t)chance();
    }
    put_u16(message, 1, its_session);
    tag = one_in(50) ? (uint8_t)chance() : (uint8_t)(tag + 1);
    message[3] = tag;
    uint8_t length = make_body(message[0], message + MESSAGE_HEADER_BYTES);
    if (one_in(20)) { /* a random body with a good CRC */
        length = (uint8_t)below(LONGEST_BODY + 1);
        for (uint8_t i = 0; i < length; i++) {
            message[MESSAGE_HEADER_BYTES + i] = (uint8_t)(one_in(2) ? chance() : below(4));
        }
    }
    return frame_encode(frame, (uint8_t)(MESSAGE_HEADER_BYTES + length));
}

/* ---- damaging them ---- */

static size_t flip(uint8_t *bytes, size_t count)
{
    for (uint32_t flips = 1 + below(3); flips != 0; flips--) {
        bytes[below((uint32_t)count)] ^= (uint8_t)(1u << below(8));
    }
    return count;
}

static size_t insert(uint8_t *bytes, size_t count)
{
    size_t at = below((uint32_t)count + 1), length = 1 + below(one_in(10) ? 80 : 4);
    memmove(bytes + at + length, bytes + at, count - at);
    for (size_t i = 0; i < length; i++) {
        bytes[at + i] = (uint8_t)chance();
    }
    return count + length;
}

static size_t repeat_part(uint8_t *bytes, size_t count)
{
    size_t at = below((uint32_t)count), length = 1 + below((uint32_t)(count - at));
    memmove(bytes + at + length, bytes + at, count - at);
    return count + length;
}

/* The beginning of one frame and the end of another. */
static size_t splice(uint8_t *bytes, size_t count)
{
    uint8_t other[LONGEST_FRAME];
    size_t other_length = make_frame(other), keep = below((uint32_t)count), from = below((uint32_t)other_length);
    memcpy(bytes + keep, other + from, other_length - from);
    return keep + other_length - from;
}

static size_t damage(uint8_t *bytes, size_t count)
{
    switch (below(6)) {
    case 0:
        return flip(bytes, count);
    case 1:
        return 1 + below((uint32_t)count);
    case 2:
        return insert(bytes, count);
    case 3:
        return repeat_part(bytes, count);
    case 4:
        return splice(bytes, count);
    default: /* the frame twice: a repeat */
        memcpy(bytes + count, bytes, count);
        return 2 * count;
    }
}

static void send_a_frame(void)
{
    uint8_t bytes[LONGEST_BURST];
    size_t count = make_frame(bytes);
    while (one_in(3) && 3 * count < LONGEST_BURST - LONGEST_FRAME) {
        count = damage(bytes, count);
    }
    send(bytes, count);
}

/* After whatever came before. */
static void send_a_good_hello(void)
{
    uint8_t frame[1 + LONGEST_FRAME] = {0, 0, KIND_HELLO, 0, 0, 0, PROTOCOL_VERSION};
    put_u16(frame, 3, 1 + below(0xFFFF));
    frame[5] = ++tag;
    long before = accepted[KIND_HELLO];
    send(frame, 1u + frame_encode(frame + 1, MESSAGE_HEADER_BYTES + 1));
    must(accepted[KIND_HELLO] > before, "a good hello isn't answered");
}

/* ---- all of it ---- */

static void read_images(char **texts, int count)
{
    must(count <= MOST_IMAGES, "too many images");
    for (image_count = 0; image_count < (unsigned)count; image_count++) {
        struct image *image = &images[image_count];
        unsigned value;
        while (sscanf(texts[image_count] + 2 * image->length, "%2x", &value) == 1) {
            image->bytes[image->length++] = (uint8_t)value;
        }
    }
}

static void print_counts(void)
{
    printf("{\"frames\": %ld", frame_number);
    for (int kind = 0; kind < 0x40; kind++) {
        if (accepted[kind] != 0) {
            printf(", \"%d\": [%ld, %ld]", kind, counts[kind], accepted[kind]);
        }
    }
    printf(", \"steps\": [%d, %d, %d, %d]}\n", port_steps[0], port_steps[1], port_steps[2], port_steps[3]);
}

int main(int count, char **words)
{
    if (count < 4) {
        fprintf(stderr, "usage: fuzz_controller FRAMES SEED IMAGE...\n");
        return 2;
    }
    long frames = strtol(words[1], NULL, 10);
    chance_state = strtoul(words[2], NULL, 10);
    read_images(words + 3, count - 3);
    memset(port_eeprom, EEPROM_ERASED, sizeof port_eeprom);
    port_eeprom_write_ticks = 1; /* written by the next round */
    port_begin();
    for (frame_number = 0; frame_number < frames; frame_number++) {
        if (frame_number % ALARM_EVERY == 0) {
            alarm(HANG_SECONDS); /* ends the program */
        }
        if (frame_number % HELLO_EVERY == 0) {
            send_a_good_hello();
        }
        send_a_frame();
        let_time_pass();
        check_all();
    }
    send_a_good_hello();
    print_counts();
    return 0;
}
