#include "requests.h"

#include <stdbool.h>
#include <string.h>

#include "chance.h"
#include "model.h"
#include "stepramp/protocol/message.h"
#include "stepramp/store/driver_settings.h"
#include "stepramp/store/ramp_keeper.h"
#include "talk.h"

enum { LONGEST_BODY = LONGEST_MESSAGE - MESSAGE_HEADER_BYTES };

static struct image delivered; /* the image being delivered */
uint8_t tag;

uint8_t put_u16(uint8_t *body, uint8_t at, uint32_t value)
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
    delivered = *some_image();
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
    struct settings settings;
    settings_set_defaults(&settings);
    settings.outputs = (uint8_t)one_in(8);
    settings.both_edges = (uint8_t)below(16);
    settings.step_inverted = (uint8_t)below(16);
    settings.direction_inverted = (uint8_t)below(16);
    settings.enable_flags = (uint8_t)below(2);
    settings.pulse_width_us = (uint8_t)below(5);
    settings.direction_setup_us = (uint16_t)(20 + below(100));
    settings.enable_lead_ms = (uint16_t)below(4);
    settings.enable_hold_ms = (uint16_t)below(5);
#if HAS_INPUTS
    static const uint8_t roles[INPUTS] = {ROLE_EMERGENCY_STOP, ROLE_DRIVER_FAULT,  ROLE_LOW_LIMIT,
                                          ROLE_LOW_LIMIT + 1,  ROLE_HIGH_LIMIT,    ROLE_HIGH_LIMIT + 1,
                                          ROLE_LOW_LIMIT + 2,  ROLE_HIGH_LIMIT + 3, ROLE_LOW_LIMIT + 3};
    settings.looks = (uint8_t)(1 + below(4));
    settings.silence_flags = (uint8_t)below(2);
    for (uint8_t i = 0; i < INPUTS; i++) {
        settings.roles[i] = one_in(3) ? 0 : roles[i];
    }
#endif
    settings_pack(&settings, body);
    if (one_in(4)) {
        body[below(SETTINGS_BYTES)] = (uint8_t)chance();
    }
    return SETTINGS_BYTES;
}

#if HAS_INPUTS
/* Near enough that motions come to them. */
static uint8_t make_limits(uint8_t *body)
{
    body[0] = (uint8_t)below(5);
    put_u32(body, 1, one_in(3) ? (uint32_t)NO_LOWEST : below(2000) - 1500);
    return put_u32(body, 5, one_in(3) ? (uint32_t)NO_HIGHEST : below(2000) - 500);
}
#endif

/* An interval that is often one that the ramp allows. */
static uint32_t some_interval(void)
{
    uint32_t interval = one_in(4) ? some_number() : 200 + below(one_in(2) ? 3000 : 100000);
    return one_in(2) ? interval : 0u - interval;
}

static uint8_t make_for_axes(uint8_t kind, uint8_t *body)
{
    uint8_t at = 1;
    if (kind == KIND_HOME) {
        at = put_u32(body, at, one_in(10) ? some_number() : 3000 + below(9000));
        at = put_u16(body, at, below(30));
    }
    body[0] = (uint8_t)(one_in(20) ? chance() : 1 + below(15) % ((1u << (ramp_keeper_axes() | 1)) - 1));
    if (kind == KIND_ZERO) {
        return put_u16(body, at, below(3000));
    }
    if (kind == KIND_LINE) {
        body[at++] = (uint8_t)below(5);
    }
    for (uint8_t i = 0; i < 8; i++) {
        if ((body[0] >> i & 1) != 0) {
            at = put_u32(body, at, kind == KIND_RUN || kind == KIND_HOME ? some_interval() : some_number());
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
#if HAS_INPUTS
    case KIND_READ_LIMITS:
        body[0] = (uint8_t)below(5);
        return 1;
    case KIND_WRITE_LIMITS:
        return make_limits(body);
#endif
    case KIND_STOP:
    case KIND_HALT:
        body[0] = (uint8_t)below(17);
        return (uint8_t)below(2);
    default:
        return (kind >= KIND_MOVE_BY && kind <= KIND_ZERO) || kind == KIND_HOME ? make_for_axes(kind, body) : 0;
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
        KIND_LINE,          KIND_LINE,    KIND_STOP,    KIND_HALT,    KIND_HALT,      KIND_WRITE_SETTINGS,
#if HAS_INPUTS
        KIND_ACKNOWLEDGE,   KIND_ACKNOWLEDGE, KIND_ACKNOWLEDGE, KIND_HOME, KIND_HOME,
        KIND_READ_LIMITS,   KIND_WRITE_LIMITS,
#endif
    };
    if (model.is_delivered_to && !one_in(20)) {
        return next_of_delivery();
    }
    return one_in(100) ? (uint8_t)chance() : kinds[below(sizeof kinds)];
}

uint8_t make_frame(uint8_t frame[LONGEST_FRAME])
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
