#include "stepramp/protocol/request_rules.h"

#include "stepramp/edge/in_flash.h"
#include "stepramp/motion/homing.h"
#include "stepramp/motion/machine.h"
#include "stepramp/protocol/message.h"
#include "stepramp/protocol/reply.h"
#include "stepramp/protocol/request.h"
#include "stepramp/store/driver_settings.h"
#include "stepramp/store/eeprom_slots.h"

/* How long its body is [bytes]. With VALUES a value for each axis of the mask that it begins with comes to that. */
enum { BODY_BITS = 0x0F, VALUES = 0x80 };
#define BODY(bytes) ((bytes) + 1) /* not 0, as an unknown request is */

static const IN_FLASH uint8_t known_requests[] = {
    [KIND_HELLO] = BODY(1) | FROM_ANYONE,
    [KIND_STATUS] = BODY(1),
    [KIND_REPORT] = BODY(1),
    [KIND_TRACE] = BODY(3),
    [KIND_BEGIN] = BODY(4) | DISTURBS,
    [KIND_DATA] = BODY(0) | DISTURBS, /* see request_length_is_good */
    [KIND_END] = BODY(0) | DISTURBS,
    [KIND_COMMIT] = BODY(0) | DISTURBS,
    [KIND_READ] = BODY(4),
    [KIND_TRY] = BODY(0) | DISTURBS,
    [KIND_ROLL_BACK] = BODY(0) | DISTURBS,
    [KIND_READ_SETTINGS] = BODY(0),
    [KIND_WRITE_SETTINGS] = BODY(OUTPUT_SETTINGS_BYTES) | DISTURBS, /* see request_length_is_good */
    [KIND_MOVE_BY] = BODY(1) | VALUES | DISTURBS | IN_FLIGHT,
    [KIND_MOVE_TO] = BODY(1) | VALUES | DISTURBS | IN_FLIGHT,
    [KIND_RUN] = BODY(1) | VALUES | DISTURBS | IN_FLIGHT,
    [KIND_LINE] = BODY(2) | VALUES | DISTURBS,
    [KIND_SET_POSITION] = BODY(1) | VALUES | DISTURBS,
    [KIND_ZERO] = BODY(3) | DISTURBS,
#if HAS_INPUTS
    [KIND_READ_LIMITS] = BODY(1),
    [KIND_WRITE_LIMITS] = BODY(1 + SOFT_LIMITS_BYTES) | DISTURBS,
    [KIND_ACKNOWLEDGE] = BODY(0),
    [KIND_HOME] = BODY(1 + HOMING_BYTES) | VALUES | DISTURBS,
#endif
    [KIND_STOP] = BODY(0) | FROM_ANYONE, /* see request_length_is_good */
    [KIND_HALT] = BODY(0) | FROM_ANYONE,
};

uint8_t request_rules(uint8_t kind)
{
#if HAS_INPUTS
    bool is_of_inputs = kind == KIND_ACKNOWLEDGE || kind == KIND_READ_LIMITS || kind == KIND_WRITE_LIMITS;
    if ((is_of_inputs && !has_inputs()) || (kind == KIND_HOME && !has_homing())) {
        return 0;
    }
#endif
    return kind < sizeof known_requests ? known_requests[kind] : 0;
}

bool request_length_is_good(uint8_t kind, uint8_t known, const uint8_t *body, uint8_t length)
{
    if (kind == KIND_DATA) {
        length = (uint8_t)(length - 3);
        return length < MOST_DATA_BYTES;
    }
    if (is_urgent(kind)) {
        return length <= 1;
    }
    if (has_inputs() && kind == KIND_WRITE_SETTINGS && length == SETTINGS_BYTES) {
        return true;
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

bool request_is_free(uint8_t known)
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
