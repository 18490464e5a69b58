#include "controller.h"

#include <stddef.h>
#include <string.h>

#include "frame.h"
#include "limits.h"
#include "message.h"
#include "player.h"
#include "ramp_image.h"
#include "ramp_store.h"
#include "reply.h"
#include "slots.h"

enum { NO_SESSION = 0 };

static struct frame_receiver receiver;
static uint16_t session = NO_SESSION;
static uint8_t answered[MESSAGE_HEADER_BYTES]; /* the header of the request answered last */

static void reply_active_ramp(void)
{
    reply_u32(slots_active().sequence);
    reply_u16(slots_active().crc);
}

/* ---- requests; `body` has the length that request_length_is_good demands ---- */

static void answer_hello(const uint8_t *body, uint16_t new_session)
{
    if (body[0] != PROTOCOL_VERSION) {
        reply_refusal(STATUS_BAD_VERSION, PROTOCOL_VERSION);
        return;
    }
    if (new_session == NO_SESSION) {
        reply_refusal(STATUS_OUT_OF_RANGE, NO_SESSION);
        return;
    }
    session = new_session;
    reply_ok();
    reply_u8(PROTOCOL_VERSION);
    reply_u8(FIRMWARE_MAJOR);
    reply_u8(FIRMWARE_MINOR);
    reply_u8(FIRMWARE_PATCH);
    reply_u32(TIMER_FREQUENCY_HZ);
    reply_u32(SHORTEST_INTERVAL_TICKS);
    reply_u32(LONGEST_INTERVAL_TICKS);
    reply_u16(LARGEST_IMAGE_BYTES);
    reply_u16(MOST_SEGMENTS);
    reply_u8(AXES);
    reply_active_ramp();
}

static void answer_status(void)
{
    struct motor_report report = player_report();
    reply_ok();
    reply_u8(ramp_store_is_writing() ? STATE_WRITING : (uint8_t)report.state);
    reply_u32((uint32_t)report.position);
    reply_u32((uint32_t)report.target);
    reply_u32(report.interval);
    reply_u32(report.steps_made);
    reply_active_ramp();
    reply_u8(ramp_store_last_write_failed());
}

static void answer_begin(const uint8_t *body)
{
    uint16_t length = read_u16(body);
    if (length > LARGEST_IMAGE_BYTES) {
        reply_refusal(STATUS_OUT_OF_RANGE, LARGEST_IMAGE_BYTES);
        return;
    }
    ramp_store_stage(length, read_u16(body + 2));
    reply_ok();
}

static void answer_data(const uint8_t *body, uint8_t body_length)
{
    const struct staged_image *staged = ramp_store_staged();
    uint8_t count = (uint8_t)(body_length - 2);
    if (staged->staging == NOTHING_BEGUN || read_u16(body) != staged->received) {
        reply_refusal(STATUS_OUT_OF_ORDER, staged->received);
        return;
    }
    if (count > staged->length - staged->received) {
        reply_refusal(STATUS_OUT_OF_RANGE, staged->length);
        return;
    }
    ramp_store_receive(body + 2, count);
    reply_ok();
    reply_u16(staged->received);
}

static void answer_end(void)
{
    struct staged_image *staged = ramp_store_staged();
    if (staged->staging == NOTHING_BEGUN || staged->received != staged->length) {
        reply_refusal(STATUS_OUT_OF_ORDER, staged->received);
        return;
    }
    if (staged->received_crc != staged->crc) {
        reply_refusal(STATUS_BAD_CRC, staged->received_crc);
        return;
    }
    struct image_check check = ramp_image_check(staged->bytes, staged->length);
    if (!check.good) {
        reply_refusal(STATUS_BAD_RAMP, check.bad_segment);
        return;
    }
    staged->staging = CHECKED;
    reply_ok();
    reply_u8(check.up_segments);
    reply_u8(check.down_segments);
}

static void answer_commit(void)
{
    const struct staged_image *staged = ramp_store_staged();
    if (staged->staging != CHECKED) {
        reply_refusal(STATUS_OUT_OF_ORDER, staged->received);
        return;
    }
    ramp_store_commit();
    reply_ok();
}

static void answer_read(const uint8_t *body)
{
    const struct staged_image *staged = ramp_store_staged();
    uint8_t source = body[0];
    uint16_t offset = read_u16(body + 1);
    uint8_t count = body[3];
    if (source > SOURCE_STAGED || count < 1 || count > MOST_DATA_BYTES) {
        reply_refusal(STATUS_OUT_OF_RANGE, source > SOURCE_STAGED ? source : count);
        return;
    }
    uint16_t total = source == SOURCE_STORED ? slots_active().length : staged->received;
    reply_ok();
    reply_u16(total);
    for (; count != 0 && offset < total; count--, offset++) {
        reply_u8(source == SOURCE_STORED ? slots_read(offset) : staged->bytes[offset]);
    }
}

/* Begins a move from `position` to `target`, whose distance may be anything up to 2^32 - 1 steps. */
static void begin_move(int32_t position, int32_t target)
{
    bool forward = target > position;
    uint32_t steps = forward ? (uint32_t)target - (uint32_t)position : (uint32_t)position - (uint32_t)target;
    if (steps != 0) {
        player_move(ramp_store_active(), steps, forward);
    }
    reply_ok();
    reply_u32((uint32_t)target);
}

static void answer_move_by(const uint8_t *body)
{
    int32_t steps = (int32_t)read_u32(body);
    int32_t position = player_report().position;
    int32_t target = (int32_t)((uint32_t)position + (uint32_t)steps);
    bool left_the_range = steps > 0 ? target < position : target > position;
    if (steps == 0 || left_the_range) {
        reply_refusal(STATUS_OUT_OF_RANGE, 0);
        return;
    }
    begin_move(position, target);
}

static void answer_stop(void)
{
    player_stop();
    reply_ok();
}

static void answer_halt(void)
{
    player_halt();
    reply_ok();
}

/* ---- dispatch ---- */

static bool kind_is_known(uint8_t kind)
{
    return kind == KIND_HELLO || kind == KIND_STATUS || (kind >= KIND_BEGIN && kind <= KIND_READ) ||
           kind == KIND_MOVE_BY || kind == KIND_MOVE_TO || kind == KIND_STOP || kind == KIND_HALT;
}

static bool request_length_is_good(uint8_t kind, uint8_t length)
{
    switch (kind) {
    case KIND_HELLO:
        return length == 1;
    case KIND_BEGIN:
    case KIND_READ:
    case KIND_MOVE_BY:
    case KIND_MOVE_TO:
        return length == 4;
    case KIND_DATA:
        return length > 2 && length <= 2 + MOST_DATA_BYTES;
    default:
        return length == 0;
    }
}

/* Refuses what would change the ramp or begin a move while one is in use. Returns false when it has refused. */
static bool motor_and_slots_are_free(void)
{
    if (player_is_moving()) {
        reply_refusal(STATUS_MOVING, 0);
        return false;
    }
    if (ramp_store_is_writing()) {
        reply_refusal(STATUS_WRITING, 0);
        return false;
    }
    return true;
}

/* Refuses a move without a ramp. Returns false when it has refused. */
static bool ramp_is_there(void)
{
    if (ramp_store_active() == NULL) {
        reply_refusal(STATUS_NO_RAMP, 0);
        return false;
    }
    return true;
}

static void answer_when_free(uint8_t kind, const uint8_t *body, uint8_t length)
{
    if (!motor_and_slots_are_free()) {
        return;
    }
    switch (kind) {
    case KIND_BEGIN:
        answer_begin(body);
        break;
    case KIND_DATA:
        answer_data(body, length);
        break;
    case KIND_END:
        answer_end();
        break;
    case KIND_COMMIT:
        answer_commit();
        break;
    case KIND_MOVE_BY:
        if (ramp_is_there()) {
            answer_move_by(body);
        }
        break;
    default: /* KIND_MOVE_TO */
        if (ramp_is_there()) {
            begin_move(player_report().position, (int32_t)read_u32(body));
        }
    }
}

static void answer_known(uint8_t kind, uint16_t its_session, const uint8_t *body, uint8_t length)
{
    switch (kind) {
    case KIND_HELLO:
        answer_hello(body, its_session);
        break;
    case KIND_STATUS:
        answer_status();
        break;
    case KIND_READ:
        answer_read(body);
        break;
    case KIND_STOP:
        answer_stop();
        break;
    case KIND_HALT:
        answer_halt();
        break;
    default:
        answer_when_free(kind, body, length);
    }
}

/* Answers a request: writes the message of the reply. */
static void answer(const uint8_t *message, uint8_t message_length)
{
    uint8_t kind = message[0];
    uint16_t its_session = read_u16(message + 1);
    uint8_t length = (uint8_t)(message_length - MESSAGE_HEADER_BYTES);
    reply_begin(kind, its_session, message[3]);
    if (kind != KIND_HELLO && (session == NO_SESSION || its_session != session)) {
        reply_refusal(STATUS_STALE_SESSION, 0);
    } else if (!kind_is_known(kind)) {
        reply_refusal(STATUS_UNKNOWN_KIND, kind);
    } else if (!request_length_is_good(kind, length)) {
        reply_refusal(STATUS_BAD_LENGTH, length);
    } else {
        answer_known(kind, its_session, message + MESSAGE_HEADER_BYTES, length);
    }
}

/* The same request as the last one: its reply was lost. A hello never counts as one, as it begins anew. */
static bool is_repeat(const uint8_t *message)
{
    return memcmp(message, answered, sizeof answered) == 0 && message[0] != KIND_HELLO;
}

void controller_receive(uint8_t byte)
{
    uint8_t length = frame_receive(&receiver, byte);
    if (length < MESSAGE_HEADER_BYTES || reply_is_going_out()) {
        return;
    }
    if (!is_repeat(receiver.bytes)) {
        answer(receiver.bytes, length);
        memcpy(answered, receiver.bytes, sizeof answered);
        reply_end();
    }
    reply_send();
}

bool controller_next_byte(uint8_t *byte)
{
    return reply_next_byte(byte);
}

void controller_begin(void)
{
    ramp_store_begin();
}

void controller_poll(void)
{
    player_poll();
    ramp_store_poll();
}
