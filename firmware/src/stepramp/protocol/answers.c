#include "stepramp/protocol/answers.h"

#include <string.h>

#include "stepramp/edge/board.h"
#include "stepramp/edge/board_limits.h"
#include "stepramp/edge/out_of_line.h"
#include "stepramp/motion/homing.h"
#include "stepramp/motion/machine.h"
#include "stepramp/motion/machine_inputs.h"
#include "stepramp/protocol/message.h"
#include "stepramp/protocol/reply.h"
#include "stepramp/protocol/report.h"
#include "stepramp/protocol/request.h"
#include "stepramp/protocol/request_rules.h"
#include "stepramp/protocol/trace.h"
#include "stepramp/store/eeprom_slots.h"
#include "stepramp/store/ramp_keeper.h"

bool stepramp_answer_gave_way;
uint8_t stepramp_answered_kind, stepramp_answered_tag;
uint16_t stepramp_session = NO_SESSION;
static bool speaks_oldest; /* version of the protocol: the client does */

/* Of a reply to `status`: its status byte included, and what inputs add. */
enum { INPUTS_STATUS_BYTES = 5, STATUS_BYTES = 27 };

/* What each build like this one has, besides inputs. */
enum { CAPABILITIES = (HAS_FORMULAS ? HAS_FORMULA_RAMPS : 0) | HAS_GAUGE_OUTPUTS | KEEPS_WITHOUT_POWER };

/* ---- what is known of the controller; `body` has the length that the request demands ---- */

static void reply_ramp_in_use(void)
{
    reply_u32(eeprom_slots_sequence());
    reply_u16(ramp_keeper_crc());
}

static void reply_limits(void)
{
    reply_u8(speaks_oldest ? OLDEST_PROTOCOL_VERSION : PROTOCOL_VERSION);
    for (uint8_t i = 1; i < TOLD_LIMITS_BYTES; i++) {
        reply_u8(stepramp_board_limits[i]);
    }
}

/* A client that begins anew gets no notices that another one has asked for. */
static void answer_hello(const uint8_t *body, uint16_t new_session)
{
    if ((uint8_t)(body[0] - OLDEST_PROTOCOL_VERSION) > PROTOCOL_VERSION - OLDEST_PROTOCOL_VERSION) {
        reply_refusal(STATUS_BAD_VERSION, PROTOCOL_VERSION);
        return;
    }
    if (new_session == NO_SESSION) {
        reply_refusal(STATUS_OUT_OF_RANGE, NO_SESSION);
        return;
    }
    stepramp_session = new_session;
    speaks_oldest = body[0] == OLDEST_PROTOCOL_VERSION;
    report_start(0, 0);
    trace_off();
    notice_drop();
    reply_limits();
    reply_u8(board_reset_cause());
    reply_ramp_in_use();
    reply_u8((uint8_t)ramp_keeper_in_use());
    if (!speaks_oldest) {
        reply_u8(has_inputs() ? CAPABILITIES | HAS_MACHINE_INPUTS | HAS_SOFT_LIMITS : CAPABILITIES);
        reply_u8(has_inputs() ? SETTINGS_BYTES : OUTPUT_SETTINGS_BYTES);
        reply_u8(has_inputs() ? STATUS_BYTES + INPUTS_STATUS_BYTES : STATUS_BYTES);
    }
}

#if HAS_INPUTS
static void reply_inputs(void)
{
    reply_u16(WITH_INPUTS(machine_active_inputs)());
    reply_u8(WITH_INPUTS(machine_stopped_by)());
    reply_u8(stepramp_known_positions);
    reply_u8(axes_homing());
}
#endif

static void answer_status(const uint8_t *body)
{
    if (body[0] >= AXES) {
        reply_refusal(STATUS_OUT_OF_RANGE, body[0]);
        return;
    }
    struct axis_report report = machine_report(body[0]); /* takes a millisecond on the fastest lines */
    stepramp_answer_gave_way = board_skip_to_stop();
    if (stepramp_answer_gave_way) {
        return;
    }
    reply_u8(eeprom_slots_are_writing() ? STATE_WRITING : machine_is_moving() ? STATE_MOVING : STATE_IDLE);
    reply_u8(report.state);
    reply_numbers(&report.position, 1);
    /* Of a run the target is its position, which another look might find a step further on. */
    reply_u32((uint32_t)(machine_runs(body[0]) ? report.position : machine_target(body[0])));
    reply_u32(machine_interval(body[0]));
    reply_numbers(&report.steps_made, 1);
    reply_ramp_in_use();
    reply_u8(machine_is_enabled() ? ramp_keeper_flags() | FLAG_ENABLED : ramp_keeper_flags());
    reply_u8(machine_starved());
#if HAS_INPUTS
    if (has_inputs() && !speaks_oldest) {
        reply_inputs();
    }
#endif
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
    uint16_t most = board_limit(LIMIT_IMAGE_BYTES);
    if (length > most) {
        reply_refusal(STATUS_OUT_OF_RANGE, most);
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

/* Nobody takes an emergency stop's role away while it is pressed; nor stores it then, as only a wrong level may keep it so. */
static bool takes_roles_in_emergency(const uint8_t *settings)
{
#if HAS_INPUTS
    enum { ROLES_AT = OUTPUT_SETTINGS_BYTES, ROLES_BYTES = SETTINGS_BYTES - OUTPUT_SETTINGS_BYTES };
    if (has_inputs() && WITH_INPUTS(machine_is_in_emergency)() &&
        (settings == NULL || memcmp(settings + ROLES_AT, ramp_keeper_settings() + ROLES_AT, ROLES_BYTES) != 0)) {
        reply_refusal(STATUS_STOPPED, WITH_INPUTS(machine_active_inputs)());
        return true;
    }
#endif
    (void)settings;
    return false;
}

/* Of the request, which nobody reads again, the bytes are the settings before then. */
static OUT_OF_LINE void answer_write_settings(uint8_t *body, uint8_t length)
{
    ramp_keeper_exchange_settings(body, length);
    uint8_t bad = settings_check(ramp_keeper_settings());
    if (bad != SETTINGS_BYTES || (length == SETTINGS_BYTES && takes_roles_in_emergency(body))) {
        ramp_keeper_exchange_settings(body, length);
    } else {
        bad = ramp_keeper_use_settings(body, length);
    }
    if (bad != SETTINGS_BYTES) {
        reply_refusal(STATUS_OUT_OF_RANGE, bad);
    }
}

#if HAS_INPUTS
/* Both requests name an axis; what is written has its lowest and highest position. */
static void answer_limits(uint8_t kind, const uint8_t *body)
{
    uint8_t axis = *body++;
    bool writes = kind == KIND_WRITE_LIMITS;
    if (axis >= AXES || (writes && (int32_t)read_u32(body) > (int32_t)read_u32(body + 4))) {
        reply_refusal(STATUS_OUT_OF_RANGE, axis);
    } else if (writes) {
        ramp_keeper_use_limits(axis, body);
    } else {
        reply_bytes(ramp_keeper_settings() + SETTINGS_BYTES + axis * SOFT_LIMITS_BYTES, SOFT_LIMITS_BYTES);
    }
}
#endif

/* ---- moves; the axes of the mask are known to be there ---- */

/* Reads a value for each axis of a mask, one after the other. */
static void read_values(uint8_t axes, const uint8_t *bytes, int32_t *values)
{
    for (; axes != 0; axes &= (uint8_t)(axes - 1), bytes += VALUE_BYTES) {
        *values++ = (int32_t)read_u32(bytes);
    }
}

/* Adds to each number of steps where that axis would come to rest, unless a stop comes in. Returns the first axis that
 * would leave the range, or MOST_AXES. */
static uint8_t make_targets(uint8_t axes, int32_t *values)
{
    for (uint8_t i = 0; i < MOST_AXES; i++, axes >>= 1) {
        stepramp_answer_gave_way = board_skip_to_stop();
        if (stepramp_answer_gave_way) {
            return i;
        }
        if ((axes & 1) == 0) {
            continue;
        }
        int32_t steps = *values;
        *values = machine_target(i);
        if (!axis_add_steps(values++, steps)) {
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
#if HAS_INPUTS
    if (has_homing() && kind == KIND_HOME) {
        read_values(axes, body + HOMING_BYTES, values);
        return WITH_HOMING(homing_begin)(axes, values, read_u32(body), read_u16(body + 4), detail);
    }
#endif
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
#if HAS_INPUTS
    if ((axes_homing() & axes) != 0) {
        reply_refusal(STATUS_MOVING, 0);
        return;
    }
#endif
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
#if HAS_INPUTS
    if (has_homing()) {
        WITH_HOMING(homing_end)(axes);
    }
#endif
    if (kind == KIND_STOP) {
        machine_stop(axes);
    } else {
        machine_halt(axes);
    }
}

/* ---- dispatch ---- */

bool answer_is_of_session(const uint8_t *message)
{
    return stepramp_session != NO_SESSION && read_u16(message + SESSION_AT) == stepramp_session;
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
        if (takes_roles_in_emergency(NULL)) {
            break;
        }
        /* fall through */
    case KIND_TRY:
        if (!(kind == KIND_TRY ? ramp_keeper_try() : ramp_keeper_commit())) {
            reply_refusal(STATUS_OUT_OF_ORDER, ramp_keeper_received());
        }
        break;
    case KIND_READ:
        answer_read(body);
        break;
    case KIND_ROLL_BACK:
        if (!takes_roles_in_emergency(NULL) && !ramp_keeper_roll_back()) {
            reply_refusal(STATUS_NO_RAMP, 0);
        }
        break;
    case KIND_READ_SETTINGS:
        reply_bytes(ramp_keeper_settings(), speaks_oldest || !has_inputs() ? OUTPUT_SETTINGS_BYTES : SETTINGS_BYTES);
        break;
    case KIND_WRITE_SETTINGS:
        answer_write_settings((uint8_t *)body, length);
        break;
#if HAS_INPUTS
    case KIND_READ_LIMITS:
    case KIND_WRITE_LIMITS:
        answer_limits(kind, body);
        break;
    case KIND_ACKNOWLEDGE:
        if (has_inputs() && !WITH_INPUTS(machine_acknowledge)()) {
            reply_refusal(STATUS_STOPPED, WITH_INPUTS(machine_active_inputs)());
        }
        break;
#endif
    case KIND_STOP:
    case KIND_HALT:
        answer_stop_or_halt(kind, body, length);
        break;
    default:
        answer_for_axes(kind, body);
    }
}

void answer(const uint8_t *message, uint8_t length)
{
    uint8_t kind = message[KIND_AT];
    const uint8_t *body = message + MESSAGE_HEADER_BYTES;
    uint8_t known = request_rules(kind);
    stepramp_answered_kind = kind;
    stepramp_answered_tag = message[TAG_AT];
    reply_begin(message);
    if ((known & FROM_ANYONE) == 0 && !answer_is_of_session(message)) {
        stepramp_answered_kind = KIND_HELLO;
        reply_refusal(STATUS_STALE_SESSION, 0);
    } else if (known == 0) {
        reply_refusal(STATUS_UNKNOWN_KIND, kind);
    } else if (!request_length_is_good(kind, known, body, length)) {
        reply_refusal(STATUS_BAD_LENGTH, length);
    } else if (request_is_free(known)) {
        answer_known(kind, read_u16(message + SESSION_AT), body, length);
    }
}
