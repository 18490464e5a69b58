#include "model.h"

#include <string.h>

#include "chance.h"
#include "must.h"
#include "stepramp/motion/homing.h"
#include "stepramp/motion/machine.h"
#include "stepramp/motion/machine_inputs.h"
#include "stepramp/protocol/message.h"
#include "stepramp/store/driver_settings.h"
#include "stepramp/store/eeprom_slots.h"
#include "stepramp/store/ramp_keeper.h"

struct model model;

static const struct image *image_in_use(void)
{
    return model.on_trial.length != 0 ? &model.on_trial : &model.stored;
}

static void check_images(void)
{
    const struct image *used = image_in_use();
    must(ramp_keeper_crc() == (used->length ? crc_of(used->bytes, used->length) : 0), "another ramp is in use");
    must(ramp_keeper_axes() == (used->length ? used->bytes[2] : 0), "another number of axes");
    if (machine_axes() != 0) {
        must(ramp_keeper_ram_length() == used->length, "a ramp of another length");
        for (uint16_t i = 0; i < used->length; i++) {
            must(stepramp_slot_content.image[i] == used->bytes[i], "another ramp is played");
        }
    }
    must(eeprom_slots_image_length(ACTIVE_SLOT) == model.stored.length, "another ramp is stored");
    must(eeprom_slots_image_length(PREVIOUS_SLOT) == model.previous.length, "another ramp was stored before");
}

/* Costs more time: not after each frame. */
static void check_slots(void)
{
    for (uint16_t i = 0; i < model.stored.length; i++) {
        must(eeprom_slots_read(ACTIVE_SLOT, i) == model.stored.bytes[i], "the stored ramp has changed");
    }
    for (uint16_t i = 0; i < model.previous.length; i++) {
        must(eeprom_slots_read(PREVIOUS_SLOT, i) == model.previous.bytes[i], "the previous ramp has changed");
    }
}

/* Homing that has come to its end has set the position. */
static void note_homed(void)
{
#if HAS_INPUTS
    static uint8_t homed_before;
    uint8_t ended = homed_before & (uint8_t)~axes_homing() & stepramp_known_positions;
    homed_before = axes_homing();
    for (uint8_t i = 0; i < PORT_AXES; i++) {
        if ((ended >> i & 1) != 0) {
            model.zero[i] = (uint32_t)machine_report(i).position - (uint32_t)port_steps[i];
        }
    }
#endif
}

static void check_positions(void)
{
    note_homed();
    for (uint8_t i = 0; i < PORT_AXES; i++) {
        uint32_t position = (uint32_t)machine_report(i).position;
        must(position == model.zero[i] + (uint32_t)port_steps[i], "a position isn't that of the motor");
    }
}

void model_note_written(void)
{
    model.is_writing = false;
    model.previous = model.stored;
    model.stored = model.being_stored;
    model.on_trial.length = 0;
    model.is_delivered_to = false;
    model.is_checked = false;
    model.settings_on_trial = false;
}

/* What is rolled back to waits until an emergency stop is over. */
static bool may_be_held(void)
{
#if HAS_INPUTS
    return machine_is_in_emergency();
#else
    return false;
#endif
}

static void finish_writing(void)
{
    for (long rounds = 0; eeprom_slots_are_writing(); rounds++) {
        if (may_be_held()) {
            return;
        }
        must(rounds < 100000, "writing doesn't end");
        port_round();
    }
    must((ramp_keeper_flags() & FLAG_WRITE_FAILED) == 0, "writing has failed");
    model_note_written();
    check_images();
    check_slots();
}

void model_check(void)
{
    if (model.is_writing && (!eeprom_slots_are_writing() || one_in(8))) {
        finish_writing();
    }
    must(settings_check(ramp_keeper_settings()) == SETTINGS_BYTES, "the settings are bad");
    check_positions();
    if (!eeprom_slots_are_writing()) {
        check_images();
    }
}

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

void model_note_dropped_delivery(void)
{
    if (model.is_delivered_to && !ramp_keeper_is_delivered_to()) {
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

void model_note_accepted(const uint8_t *message, uint8_t length)
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
    case KIND_WRITE_LIMITS:
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
