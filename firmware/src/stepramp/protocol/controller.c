#include "stepramp/protocol/controller.h"

#include "stepramp/edge/board.h"
#include "stepramp/edge/board_limits.h"
#include "stepramp/edge/in_flash.h"
#include "stepramp/edge/out_of_line.h"
#include "stepramp/motion/feed.h"
#include "stepramp/motion/machine.h"
#include "stepramp/protocol/message.h"
#include "stepramp/protocol/reply.h"
#include "stepramp/protocol/report.h"
#include "stepramp/protocol/request.h"
#include "stepramp/protocol/trace.h"
#include "stepramp/store/eeprom_slots.h"
#include "stepramp/store/ramp_keeper.h"

/* A run has no end of its own: it ends when nobody has asked for anything for so long [256 ms]. A program that has died,
 * or a cable that has been pulled, leaves no motor running. */
enum { MOST_SILENCE = 4 };

/* So long motors that need all of the time keep requests and notices waiting [ms]. */
enum { MOST_PATIENCE_MS = 40 };

enum { NO_SESSION = 0 };

/* Where the fields of a message's header lie. */
enum { KIND_AT = 0, SESSION_AT = 1, TAG_AT = 3 };

static bool is_written; /* the reply to the request that waits, which is not a frame yet */
static bool gave_way;   /* its answer, to a stop that has come in: it is begun anew, should that turn out to be none */
static uint16_t session = NO_SESSION;
static uint8_t answered_kind, answered_tag; /* the request answered last */
static uint8_t heard;                       /* when the last request came: board_milliseconds() / 256 */

/* ---- what is known of the controller; `body` has the length that expected_length demands ---- */

static void reply_ramp_in_use(void)
{
    reply_u32(eeprom_slots_sequence());
    reply_u16(ramp_keeper_crc());
}

/* Little-endian bytes of a number. */
#define BYTES_U16(number) (number) & 0xFF, (number) >> 8
#define BYTES_U32(number) BYTES_U16((number) & 0xFFFF), BYTES_U16((number) >> 16)

static const IN_FLASH uint8_t limits[] = {
    PROTOCOL_VERSION,
    FIRMWARE_MAJOR,
    FIRMWARE_MINOR,
    FIRMWARE_PATCH,
    BYTES_U32(FAST_CLOCK_HZ),
    BYTES_U32(SLOW_CLOCK_HZ),
    BYTES_U16(SHORTEST_INTERVAL_1_AXIS_TICKS),
    BYTES_U16(SHORTEST_INTERVAL_2_AXES_TICKS),
    BYTES_U16(SHORTEST_INTERVAL_3_AXES_TICKS),
    BYTES_U16(SHORTEST_INTERVAL_4_AXES_TICKS),
    BYTES_U16(SHORTEST_INTERVAL_LINE_2_TICKS),
    BYTES_U16(SHORTEST_INTERVAL_LINE_3_TICKS),
    BYTES_U16(SHORTEST_INTERVAL_LINE_4_TICKS),
    BYTES_U32(LONGEST_INTERVAL_TICKS),
    BYTES_U16(SHORTEST_FORMULA_INTERVAL_TICKS),
    BYTES_U16(LARGEST_IMAGE_BYTES),
    MOST_SEGMENTS,
    AXES,
};

static void reply_limits(void)
{
    for (uint8_t i = 0; i < sizeof limits; i++) {
        reply_u8(limits[i]);
    }
}

/* A client that begins anew gets no notices that another one has asked for. */
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
    report_start(0, 0);
    trace_off();
    notice_drop();
    reply_limits();
    reply_u8(board_reset_cause());
    reply_ramp_in_use();
    reply_u8((uint8_t)ramp_keeper_in_use());
}

static void answer_status(const uint8_t *body)
{
    if (body[0] >= AXES) {
        reply_refusal(STATUS_OUT_OF_RANGE, body[0]);
        return;
    }
    struct axis_report report = machine_report(body[0]); /* takes a millisecond on the fastest lines */
    gave_way = board_skip_to_stop();
    if (gave_way) {
        return;
    }
    reply_u8(eeprom_slots_are_writing() ? STATE_WRITING : machine_is_moving() ? STATE_MOVING : STATE_IDLE);
    reply_u8(report.state);
    reply_numbers(&report.position, 1);
    /* Of a run the target is its position, which another look might find a step further on. */
    reply_u32((uint32_t)(machine_runs(body[0]) ? report.position : machine_target(body[0])));
    reply_numbers(&report.interval, 2); /* and steps made */
    reply_ramp_in_use();
    reply_u8(machine_is_enabled() ? ramp_keeper_flags() | FLAG_ENABLED : ramp_keeper_flags());
    reply_u8(machine_starved());
}

static void answer_report(const uint8_t *body)
{
    if (body[0] > MOST_REPORTS_HZ) {
        reply_refusal(STATUS_OUT_OF_RANGE, body[0]);
    } else {
        report_start(body[0], board_milliseconds());
    }
}

static void answer_trace(const uint8_t *body)
{
    uint8_t axis = body[0];
    uint16_t every = read_u16(body + 1);
    if (axis == TRACE_OFF) {
        trace_off();
    } else if (axis >= ramp_keeper_axes()) {
        reply_refusal(STATUS_OUT_OF_RANGE, axis);
        return;
    } else {
        uint16_t least = ramp_keeper_trace_every(axis);
        every = every < least ? least : every;
        trace_arm(axis, every);
    }
    reply_u16(every);
}

/* ---- ramps and settings ---- */

static void answer_begin(const uint8_t *body)
{
    uint16_t length = read_u16(body);
    if (length > LARGEST_IMAGE_BYTES) {
        reply_refusal(STATUS_OUT_OF_RANGE, LARGEST_IMAGE_BYTES);
    } else {
        ramp_keeper_deliver(length, read_u16(body + 2));
    }
}

static void answer_end(void)
{
    uint16_t detail;
    uint8_t status = ramp_keeper_check(&detail);
    reply_u8(ramp_image_axes(stepramp_slot_content.image));
    reply_u8(ramp_image_ramps(stepramp_slot_content.image));
    reply_status(status, detail);
}

static void answer_read(const uint8_t *body)
{
    uint8_t source = body[0], count = body[3];
    uint16_t offset = read_u16(body + 1);
    if (source > SOURCE_PREVIOUS || count < 1 || count > MOST_DATA_BYTES) {
        reply_refusal(STATUS_OUT_OF_RANGE, source > SOURCE_PREVIOUS ? source : count);
        return;
    }
    bool is_ram = source == SOURCE_RAM;
    enum slot_choice slot = source == SOURCE_STORED ? ACTIVE_SLOT : PREVIOUS_SLOT;
    uint16_t total = is_ram ? ramp_keeper_ram_length() : eeprom_slots_image_length(slot);
    reply_u16(total);
    for (; count != 0 && offset < total; count--, offset++) {
        reply_u8(is_ram ? stepramp_slot_content.image[offset] : eeprom_slots_read(slot, offset));
    }
}

static void answer_write_settings(const uint8_t *body)
{
    uint8_t bad = settings_check(body);
    if (bad != SETTINGS_BYTES) {
        reply_refusal(STATUS_OUT_OF_RANGE, bad);
    } else {
        ramp_keeper_use_settings(body);
    }
}

/* ---- moves; the axes of the mask are known to be there ---- */

/* Reads a value for each axis of a mask. */
static void read_values(uint8_t axes, const uint8_t *bytes, int32_t values[MOST_AXES])
{
    for (uint8_t i = 0; i < MOST_AXES; i++, axes >>= 1) {
        values[i] = 0;
        if ((axes & 1) != 0) {
            values[i] = (int32_t)read_u32(bytes);
            bytes += VALUE_BYTES;
        }
    }
}

/* Adds to each number of steps where that axis would come to rest, unless a stop comes in. Returns the first axis that
 * would leave the range, or MOST_AXES. */
static uint8_t make_targets(uint8_t axes, int32_t values[MOST_AXES])
{
    for (uint8_t i = 0; i < MOST_AXES; i++, axes >>= 1) {
        gave_way = board_skip_to_stop();
        if (gave_way) {
            return i;
        }
        if ((axes & 1) == 0) {
            continue;
        }
        int32_t steps = values[i];
        values[i] = machine_target(i);
        if (!axis_add_steps(&values[i], steps)) {
            return i;
        }
    }
    return MOST_AXES;
}

/* Answers a move that has begun with its targets. */
static void reply_targets(uint8_t axes)
{
    for (uint8_t i = 0; i < MOST_AXES; i++, axes >>= 1) {
        if ((axes & 1) != 0) {
            reply_u32((uint32_t)machine_target(i));
        }
    }
}

/* Begins a motion. Returns its status. */
static uint8_t move(uint8_t kind, uint8_t axes, const uint8_t *body, uint16_t *detail)
{
    int32_t values[MOST_AXES];
    read_values(axes, kind == KIND_LINE ? body + 1 : body, values);
    if (kind == KIND_LINE) {
        return machine_line(axes, body[0], values, detail);
    }
    if (kind == KIND_RUN) {
        return machine_run(axes, values, detail);
    }
    if (kind == KIND_SET_POSITION) {
        machine_set_position(axes, values);
        return STATUS_OK;
    }
    if (kind == KIND_MOVE_BY) {
        *detail = make_targets(axes, values);
        if (*detail != MOST_AXES) {
            return STATUS_OUT_OF_RANGE;
        }
    }
    return machine_move_to(axes, values, detail);
}

/* Some of the axes that the ramp in use has, and no others. */
static bool mask_is_good(uint8_t axes)
{
    if (axes != 0 && axes >> ramp_keeper_axes() == 0) {
        return true;
    }
    reply_refusal(STATUS_OUT_OF_RANGE, axes);
    return false;
}

/* A request that names axes, all at rest or free to change what they do. */
static void answer_for_axes(uint8_t kind, const uint8_t *body)
{
    uint8_t axes = *body++;
    uint16_t detail = 0;
    if (!ramp_keeper_make_ready()) {
        reply_refusal(STATUS_NO_RAMP, 0);
        return;
    }
    if (!mask_is_good(axes)) {
        return;
    }
    uint8_t status = kind == KIND_ZERO ? machine_zero(axes, read_u16(body), &detail) : move(kind, axes, body, &detail);
    if (status != STATUS_OK) {
        reply_refusal(status, detail);
    } else if (kind <= KIND_MOVE_TO || kind == KIND_LINE) {
        reply_targets(axes);
    }
}

/* Without a mask: all axes. */
static void answer_stop_or_halt(uint8_t kind, const uint8_t *body, uint8_t length)
{
    uint8_t axes = length == 0 ? (1u << AXES) - 1 : body[0];
    if (length != 0 && !mask_is_good(axes)) {
        return;
    }
    if (kind == KIND_STOP) {
        machine_stop(axes);
    } else {
        machine_halt(axes);
    }
}

/* ---- dispatch ---- */

/* What is to be known of a kind of request: who may ask, and when. Those that would disturb a move or a write wait for its
 * end; but what may come in flight changes what a motor does while it moves. */
enum { FROM_ANYONE = 0x10, DISTURBS = 0x20, IN_FLIGHT = 0x40 };

/* And how long its body is [bytes]. With VALUES a value for each axis of the mask that it begins with comes to that. */
enum { BODY_BITS = 0x0F, VALUES = 0x80 };
#define BODY(bytes) ((bytes) + 1) /* not 0, as an unknown request is */

static const IN_FLASH uint8_t known_requests[] = {
    [KIND_HELLO] = BODY(1) | FROM_ANYONE,
    [KIND_STATUS] = BODY(1),
    [KIND_REPORT] = BODY(1),
    [KIND_TRACE] = BODY(3),
    [KIND_BEGIN] = BODY(4) | DISTURBS,
    [KIND_DATA] = BODY(0) | DISTURBS, /* see length_is_good */
    [KIND_END] = BODY(0) | DISTURBS,
    [KIND_COMMIT] = BODY(0) | DISTURBS,
    [KIND_READ] = BODY(4),
    [KIND_TRY] = BODY(0) | DISTURBS,
    [KIND_ROLL_BACK] = BODY(0) | DISTURBS,
    [KIND_READ_SETTINGS] = BODY(0),
    [KIND_WRITE_SETTINGS] = BODY(SETTINGS_BYTES) | DISTURBS,
    [KIND_MOVE_BY] = BODY(1) | VALUES | DISTURBS | IN_FLIGHT,
    [KIND_MOVE_TO] = BODY(1) | VALUES | DISTURBS | IN_FLIGHT,
    [KIND_RUN] = BODY(1) | VALUES | DISTURBS | IN_FLIGHT,
    [KIND_LINE] = BODY(2) | VALUES | DISTURBS,
    [KIND_SET_POSITION] = BODY(1) | VALUES | DISTURBS,
    [KIND_ZERO] = BODY(3) | DISTURBS,
    [KIND_STOP] = BODY(0) | FROM_ANYONE, /* see length_is_good */
    [KIND_HALT] = BODY(0) | FROM_ANYONE,
};

static bool length_is_good(uint8_t kind, uint8_t known, const uint8_t *body, uint8_t length)
{
    if (kind == KIND_DATA) {
        length = (uint8_t)(length - 3);
        return length < MOST_DATA_BYTES;
    }
    if (is_urgent(kind)) {
        return length <= 1;
    }
    length = BODY(length);
    if ((known & VALUES) != 0) {
        for (uint8_t mask = body[0]; mask != 0; mask &= (uint8_t)(mask - 1)) {
            length = (uint8_t)(length - VALUE_BYTES);
        }
    }
    known &= BODY_BITS;
    return length == known;
}

/* Refuses what would disturb a move or a write. Returns false when it has refused. */
static bool is_free_for(uint8_t known)
{
    if ((known & DISTURBS) == 0) {
        return true;
    }
    if ((known & IN_FLIGHT) != 0 ? machine_is_on_a_line() : machine_is_moving()) {
        reply_refusal(STATUS_MOVING, 0);
        return false;
    }
    if (eeprom_slots_are_writing()) {
        reply_refusal(STATUS_WRITING, 0);
        return false;
    }
    return true;
}

static void answer_data(const uint8_t *body, uint8_t length)
{
    uint16_t detail;
    uint8_t status = ramp_keeper_receive(read_u16(body), (uint8_t)(length - 2), &detail);
    reply_u16(ramp_keeper_received());
    reply_status(status, detail);
}

static void answer_known(uint8_t kind, uint16_t its_session, const uint8_t *body, uint8_t length)
{
    switch (kind) {
    case KIND_HELLO:
        answer_hello(body, its_session);
        break;
    case KIND_STATUS:
        answer_status(body);
        break;
    case KIND_REPORT:
        answer_report(body);
        break;
    case KIND_TRACE:
        answer_trace(body);
        break;
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
    case KIND_TRY:
        if (!(kind == KIND_TRY ? ramp_keeper_try() : ramp_keeper_commit())) {
            reply_refusal(STATUS_OUT_OF_ORDER, ramp_keeper_received());
        }
        break;
    case KIND_READ:
        answer_read(body);
        break;
    case KIND_ROLL_BACK:
        if (!ramp_keeper_roll_back()) {
            reply_refusal(STATUS_NO_RAMP, 0);
        }
        break;
    case KIND_READ_SETTINGS:
        reply_bytes(ramp_keeper_settings(), SETTINGS_BYTES);
        break;
    case KIND_WRITE_SETTINGS:
        answer_write_settings(body);
        break;
    case KIND_STOP:
    case KIND_HALT:
        answer_stop_or_halt(kind, body, length);
        break;
    default:
        answer_for_axes(kind, body);
    }
}

static OUT_OF_LINE bool is_of_session(const uint8_t *message)
{
    return session != NO_SESSION && read_u16(message + SESSION_AT) == session;
}

/* Answers a request, whose body has this length: writes the message of the reply. */
static void answer(const uint8_t *message, uint8_t length)
{
    uint8_t kind = message[KIND_AT];
    const uint8_t *body = message + MESSAGE_HEADER_BYTES;
    uint8_t known = kind < sizeof known_requests ? known_requests[kind] : 0;
    answered_kind = kind;
    answered_tag = message[TAG_AT];
    reply_begin(message);
    if ((known & FROM_ANYONE) == 0 && !is_of_session(message)) {
        answered_kind = KIND_HELLO;
        reply_refusal(STATUS_STALE_SESSION, 0);
    } else if (known == 0) {
        reply_refusal(STATUS_UNKNOWN_KIND, kind);
    } else if (!length_is_good(kind, known, body, length)) {
        reply_refusal(STATUS_BAD_LENGTH, length);
    } else if (is_free_for(known)) {
        answer_known(kind, read_u16(message + SESSION_AT), body, length);
    }
}

/* Makes what has been written a frame. */
static void send_reply(void)
{
    reply_end();
    reply_send();
    stepramp_requests.waiting_length = 0;
    is_written = false;
}

/* The same request as the last one: its reply was lost. A hello never counts as one, as it begins anew; nor does a
 * request of another session, which changes nothing and so is simply answered again. */
static bool is_repeat(void)
{
    const uint8_t *request = stepramp_requests.kept;
    return request[KIND_AT] == answered_kind && request[TAG_AT] == answered_tag && answered_kind != KIND_HELLO &&
           is_of_session(request);
}

/* What waits or is being sent gives way to a stop or halt: what has not begun then doesn't begin any more. Other requests
 * wait until there is time for them, one at a time. */
void controller_obey(uint8_t length)
{
    heard = (uint8_t)(board_milliseconds() >> 8);
    const uint8_t *message = stepramp_requests.is_beside ? stepramp_requests.urgent : stepramp_requests.kept;
    if (is_urgent(message[KIND_AT])) {
        reply_cut();
        answer(message, (uint8_t)(length - MESSAGE_HEADER_BYTES));
        send_reply();
    } else if (!stepramp_requests.is_beside && !reply_is_going_out()) {
        stepramp_requests.waiting_length = length;
    }
}

/* Goes on with the request that waits. Returns false when none does. */
static bool answer_waiting(void)
{
    if (stepramp_requests.waiting_length == 0) {
        return false;
    }
    if (is_written) {
        send_reply();
    } else if (is_repeat()) {
        reply_send();
        stepramp_requests.waiting_length = 0;
    } else {
        answer(stepramp_requests.kept, (uint8_t)(stepramp_requests.waiting_length - MESSAGE_HEADER_BYTES));
        is_written = !gave_way;
        if (gave_way) {
            answered_kind = KIND_HELLO; /* nothing has been answered that could be asked for again */
            gave_way = false;
        }
    }
    return true;
}

void controller_begin(void)
{
    machine_begin();
    ramp_keeper_begin();
}

/* Goes on with what can wait until motors have what they need. Reports come at fixed times, so they go before traces,
 * which have room for all that waits in the meantime. */
static void go_on(uint16_t now_ms)
{
    if ((uint8_t)((now_ms >> 8) - heard) > MOST_SILENCE) {
        machine_stop_runs();
    }
    ramp_keeper_poll();
    if (!answer_waiting() && !report_poll(session, now_ms)) {
        trace_poll(session, now_ms);
    }
}

void controller_poll(void)
{
    static uint8_t had_time_ms;
    reply_poll();
    uint16_t now_ms = board_milliseconds();
    if (machine_poll() || (uint8_t)(now_ms - had_time_ms) >= MOST_PATIENCE_MS) {
        had_time_ms = (uint8_t)now_ms;
        go_on(now_ms);
    }
}
