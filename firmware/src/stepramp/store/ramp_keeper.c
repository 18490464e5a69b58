#include "stepramp/store/ramp_keeper.h"

#include <stddef.h>
#include <string.h>

#include "stepramp/edge/out_of_line.h"
#include "stepramp/motion/machine.h"
#include "stepramp/motion/machine_inputs.h"
#include "stepramp/protocol/frame.h"
#include "stepramp/protocol/message.h"
#include "stepramp/store/eeprom_slots.h"

/* The image in RAM, and its settings, are stepramp_slot_content; its length is stepramp_slot_image_length. */

enum { TRACE_VALUES_A_SECOND = 1000 };

/* What the image in RAM is. */
enum content { NOTHING, RECEIVING, CHECKED, ON_TRIAL, STORED };

static uint8_t content = NOTHING;
static uint8_t flags;     /* FLAG_WRITE_FAILED; FLAG_ON_TRIAL of the settings only */
static uint16_t received; /* [bytes] of the image: those behind are free */
static uint16_t crc;      /* of the image in RAM, or announced for it */

static OUT_OF_LINE bool is_playable(void)
{
    return content >= ON_TRIAL;
}

/* ---- what is in use ---- */

/* The settings in RAM are packed. Where that is how a struct lies, they are one. */
static const struct settings *settings_in_use(void)
{
#if IS_LITTLE_ENDIAN
    return &stepramp_slot_content.settings;
#else
    static struct settings settings;
    settings = settings_unpack(ramp_keeper_settings());
#if HAS_INPUTS
    memcpy(settings.soft_limits, stepramp_slot_content.settings.soft_limits, sizeof settings.soft_limits);
#endif
    return &settings;
#endif
}

/* Gives the machine what it is to use. */
static void use(void)
{
    machine_use(is_playable() ? stepramp_slot_content.image : NULL, settings_in_use());
}

/* Takes note of the image in RAM, which is the stored one now; or there is none. */
static void use_stored_image(bool is_there)
{
    content = is_there ? STORED : NOTHING;
    received = is_there ? stepramp_slot_image_length : 0;
    crc = frame_crc16(stepramp_slot_content.image, received);
    use();
}

/* The same, and the settings are the stored ones, too. */
static void use_stored(bool is_there)
{
    flags &= (uint8_t)~FLAG_ON_TRIAL;
    if (!is_there) {
        eeprom_slots_use_defaults();
    }
    use_stored_image(is_there);
}

void ramp_keeper_begin(void)
{
    flags = 0;
    use_stored(eeprom_slots_find());
}

enum ramp_in_use ramp_keeper_in_use(void)
{
    return content == ON_TRIAL ? RAMP_ON_TRIAL : eeprom_slots_hold(ACTIVE_SLOT) ? STORED_RAMP : NO_RAMP;
}

uint16_t ramp_keeper_crc(void)
{
    return is_playable() ? crc : eeprom_slots_hold(ACTIVE_SLOT) ? eeprom_slots_image_crc(ACTIVE_SLOT) : 0;
}

uint8_t ramp_keeper_axes(void)
{
    if (is_playable()) {
        return ramp_image_axes(stepramp_slot_content.image);
    }
    return eeprom_slots_hold(ACTIVE_SLOT) ? eeprom_slots_read(ACTIVE_SLOT, RAMP_IMAGE_AXES_AT) : 0;
}

uint8_t ramp_keeper_flags(void)
{
    return content == ON_TRIAL ? flags | FLAG_ON_TRIAL : flags;
}

/* All of it has 16 bits when the slew interval is less than that of so many values. */
uint16_t ramp_keeper_trace_every(uint8_t axis)
{
    if (!is_playable()) {
        return 1;
    }
    bool is_fast = ramp_image_is_fast(stepramp_slot_content.image);
    uint16_t ticks_a_value = is_fast ? FAST_CLOCK_HZ / TRACE_VALUES_A_SECOND : SLOW_CLOCK_HZ / TRACE_VALUES_A_SECOND;
    uint32_t slew_interval = ramp_image_slew_interval(stepramp_slot_content.image, axis);
    if (slew_interval >= ticks_a_value) {
        return 1;
    }
    uint16_t slew_ticks = (uint16_t)slew_interval;
    return (uint16_t)(ticks_a_value + slew_ticks - 1) / slew_ticks;
}

bool ramp_keeper_make_ready(void)
{
    if (!is_playable() && eeprom_slots_hold(ACTIVE_SLOT)) {
        use_stored_image(eeprom_slots_load_image());
    }
    return is_playable();
}

const uint8_t *ramp_keeper_settings(void)
{
    return (const uint8_t *)&stepramp_slot_content.settings;
}

#if HAS_INPUTS
enum { ROLES_AT = offsetof(struct settings, roles) };
#endif

void ramp_keeper_exchange_settings(uint8_t *bytes, uint8_t count)
{
    uint8_t *in_use = (uint8_t *)&stepramp_slot_content.settings;
    for (; count != 0; count--) {
        uint8_t byte = *bytes;
        *bytes++ = *in_use;
        *in_use++ = byte;
    }
}

uint8_t ramp_keeper_use_settings(uint8_t *before, uint8_t count)
{
    use();
#if HAS_INPUTS
    uint8_t input = EMERGENCY_INPUTS;
    if (has_inputs() && count == SETTINGS_BYTES) {
        input = WITH_INPUTS(machine_new_stop)(before + ROLES_AT, ramp_keeper_settings() + ROLES_AT);
    }
    if (input != EMERGENCY_INPUTS) {
        ramp_keeper_exchange_settings(before, count);
        use();
        WITH_INPUTS(emergency_release)(); /* latched by those settings; or one that is active still, which stays */
        return (uint8_t)(ROLES_AT + input);
    }
#endif
    (void)before, (void)count;
    flags |= FLAG_ON_TRIAL;
    return SETTINGS_BYTES;
}

#if HAS_INPUTS
void ramp_keeper_use_limits(uint8_t axis, const uint8_t bytes[SOFT_LIMITS_BYTES])
{
    memcpy(stepramp_slot_content.settings.soft_limits[axis], bytes, SOFT_LIMITS_BYTES);
    flags |= FLAG_ON_TRIAL;
    use();
}
#endif

/* ---- delivery ---- */

void ramp_keeper_deliver(uint16_t length, uint16_t announced_crc)
{
    content = RECEIVING;
    stepramp_slot_image_length = length;
    received = 0;
    crc = announced_crc;
    use();
}

bool ramp_keeper_is_delivered_to(void)
{
    return content == RECEIVING || content == CHECKED;
}

uint16_t ramp_keeper_received(void)
{
    return ramp_keeper_is_delivered_to() ? received : 0;
}

void ramp_keeper_put(uint8_t index, uint8_t byte)
{
    uint16_t offset = received + index;
    if (offset < stepramp_slot_image_length) {
        stepramp_slot_content.image[offset] = byte;
    }
}

uint8_t ramp_keeper_receive(uint16_t offset, uint8_t count, uint16_t *detail)
{
    *detail = ramp_keeper_received();
    if (!ramp_keeper_is_delivered_to() || offset != received) {
        return STATUS_OUT_OF_ORDER;
    }
    if (count > stepramp_slot_image_length - received) {
        *detail = stepramp_slot_image_length;
        return STATUS_OUT_OF_RANGE;
    }
    received += count;
    return STATUS_OK;
}

uint8_t ramp_keeper_check(uint16_t *detail)
{
    *detail = ramp_keeper_received();
    if (!ramp_keeper_is_delivered_to() || received != stepramp_slot_image_length) {
        return STATUS_OUT_OF_ORDER;
    }
    *detail = frame_crc16(stepramp_slot_content.image, received);
    if (*detail != crc) {
        return STATUS_BAD_CRC;
    }
    struct image_check check = ramp_image_check(stepramp_slot_content.image, received);
    if (!check.good) {
        *detail = check.bad;
        return STATUS_BAD_RAMP;
    }
    content = CHECKED;
    return STATUS_OK;
}

bool ramp_keeper_try(void)
{
    if (content != CHECKED) {
        return false;
    }
    content = ON_TRIAL;
    use();
    return true;
}

/* ---- storing ---- */

bool ramp_keeper_commit(void)
{
    if (content < CHECKED) {
        return false;
    }
    flags &= (uint8_t)~FLAG_WRITE_FAILED;
    eeprom_slots_begin_write();
    return true;
}

/* The previous ramp is loaded now, to be sure of it, and comes into use when its slot is the active one. */
static bool roll_back_to_previous(void)
{
    if (!eeprom_slots_hold(PREVIOUS_SLOT)) {
        return false;
    }
    content = NOTHING;
    use();
    if (!eeprom_slots_load(PREVIOUS_SLOT)) {
        use_stored(eeprom_slots_load(ACTIVE_SLOT));
        return false;
    }
    flags &= (uint8_t)~FLAG_WRITE_FAILED;
    received = stepramp_slot_image_length;
    eeprom_slots_begin_roll_back();
    return true;
}

bool ramp_keeper_roll_back(void)
{
    if (ramp_keeper_is_delivered_to() || (ramp_keeper_flags() & FLAG_ON_TRIAL) != 0) {
        use_stored(eeprom_slots_load(ACTIVE_SLOT));
        return true;
    }
    return roll_back_to_previous();
}

/* Rolled back to may be settings that give the emergency stop's input another role: it waits until that is over. */
static bool is_held(void)
{
#if HAS_INPUTS
    return content == NOTHING && has_inputs() && WITH_INPUTS(machine_is_in_emergency)();
#else
    return false;
#endif
}

void ramp_keeper_poll(void)
{
    if (is_held()) {
        return;
    }
    enum write_progress progress = eeprom_slots_poll();
    if (progress == WRITTEN) {
        use_stored(true);
    } else if (progress == WRITE_FAILED) {
        flags |= FLAG_WRITE_FAILED;
        if (content == NOTHING) { /* the previous ramp is in RAM, to be rolled back to */
            use_stored(eeprom_slots_load(ACTIVE_SLOT));
        }
    }
}

uint16_t ramp_keeper_ram_length(void)
{
    return received;
}
