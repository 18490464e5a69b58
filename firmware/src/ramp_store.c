#include "ramp_store.h"

#include <stddef.h>

#include "frame.h"
#include "ramp_image.h"
#include "slots.h"

static struct ramp active; /* good when slots_active() has a sequence number */
static struct staged_image staged;
static struct image_reader unpacking; /* of the staged image into the active ramp, after it has been written */
static bool is_unpacking;
static bool last_write_failed;

void ramp_store_begin(void)
{
    if (slots_find(staged.bytes)) {
        ramp_image_begin_unpacking(&unpacking, staged.bytes, slots_active().length, &active);
        while (ramp_image_unpack_segment(&unpacking, &active)) {
        }
    }
}

void ramp_store_poll(void)
{
    switch (slots_poll()) {
    case WRITTEN:
        ramp_image_begin_unpacking(&unpacking, staged.bytes, staged.length, &active);
        is_unpacking = true;
        break;
    case WRITE_FAILED:
        last_write_failed = true;
        break;
    default:
        is_unpacking = is_unpacking && ramp_image_unpack_segment(&unpacking, &active);
    }
}

const struct ramp *ramp_store_active(void)
{
    return slots_active().sequence == 0 ? NULL : &active;
}

struct staged_image *ramp_store_staged(void)
{
    return &staged;
}

void ramp_store_stage(uint16_t length, uint16_t crc)
{
    staged.length = length;
    staged.crc = crc;
    staged.received = 0;
    staged.received_crc = CRC16_START;
    staged.staging = RECEIVING;
}

void ramp_store_receive(const uint8_t *bytes, uint8_t count)
{
    for (uint8_t i = 0; i < count; i++) {
        staged.bytes[staged.received++] = bytes[i];
        staged.received_crc = crc16_update(staged.received_crc, bytes[i]);
    }
}

void ramp_store_commit(void)
{
    last_write_failed = false;
    slots_begin_write(staged.bytes, staged.length, staged.crc);
}

bool ramp_store_is_writing(void)
{
    return slots_are_writing() || is_unpacking;
}

bool ramp_store_last_write_failed(void)
{
    return last_write_failed;
}
