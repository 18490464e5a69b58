#include "slots.h"

#include <stddef.h>
#include <string.h>

#include "frame.h"
#include "port.h"
#include "ramp_image.h"

enum { MAGIC = 0x53, SLOT_FORMAT = 1, NO_SLOT = 0xFF, ERASED = 0xFF };

/* A write goes through these stages in this order, each from its last byte back to its first, so that the very last
 * byte written is the first of the header, without which a slot is none. */
enum stage { REST, INVALIDATE_HEADER, WRITE_IMAGE, CHECK_IMAGE, WRITE_HEADER, CHECK_HEADER };

static uint8_t active_slot = NO_SLOT;
static struct stored_image active;

static struct {
    enum stage stage;
    uint8_t slot;
    uint16_t left; /* bytes left in this stage, counted from the first byte of what it writes or checks */
    const uint8_t *image;
    struct stored_image stored;
    uint8_t header[SLOT_HEADER_BYTES];
} writing;

static uint16_t address_of(uint8_t slot, uint16_t offset)
{
    return (uint16_t)(slot * SLOT_BYTES + offset);
}

static uint16_t header_crc(const uint8_t header[SLOT_HEADER_BYTES])
{
    uint16_t crc = CRC16_START;
    for (uint8_t i = 0; i < SLOT_HEADER_BYTES - CRC_BYTES; i++) {
        crc = crc16_update(crc, header[i]);
    }
    return crc;
}

static void make_header(uint8_t header[SLOT_HEADER_BYTES], const struct stored_image *stored)
{
    header[0] = MAGIC;
    header[1] = SLOT_FORMAT;
    header[2] = (uint8_t)stored->length;
    header[3] = (uint8_t)(stored->length >> 8);
    for (uint8_t i = 0; i < 4; i++) {
        header[4 + i] = (uint8_t)(stored->sequence >> (8 * i));
    }
    header[8] = (uint8_t)stored->crc;
    header[9] = (uint8_t)(stored->crc >> 8);
    uint16_t crc = header_crc(header);
    header[10] = (uint8_t)crc;
    header[11] = (uint8_t)(crc >> 8);
}

/* Reads a slot's header. Returns false, and a sequence of 0, when it is none. */
static bool read_header(uint8_t slot, struct stored_image *stored)
{
    uint8_t header[SLOT_HEADER_BYTES], expected[SLOT_HEADER_BYTES];
    for (uint8_t i = 0; i < SLOT_HEADER_BYTES; i++) {
        header[i] = port_eeprom_read(address_of(slot, i));
    }
    stored->length = (uint16_t)(header[2] | (uint16_t)header[3] << 8);
    stored->sequence = 0;
    for (uint8_t i = 0; i < 4; i++) {
        stored->sequence |= (uint32_t)header[4 + i] << (8 * i);
    }
    stored->crc = (uint16_t)(header[8] | (uint16_t)header[9] << 8);
    make_header(expected, stored);
    if (memcmp(header, expected, sizeof header) == 0 && stored->length <= LARGEST_IMAGE_BYTES) {
        return true;
    }
    stored->sequence = 0;
    return false;
}

static bool load_if_good(uint8_t slot, uint8_t image[LARGEST_IMAGE_BYTES])
{
    struct stored_image stored;
    if (!read_header(slot, &stored)) {
        return false;
    }
    uint16_t crc = CRC16_START;
    for (uint16_t i = 0; i < stored.length; i++) {
        image[i] = port_eeprom_read(address_of(slot, SLOT_HEADER_BYTES + i));
        crc = crc16_update(crc, image[i]);
    }
    if (crc != stored.crc || !ramp_image_check(image, stored.length).good) {
        return false;
    }
    active_slot = slot;
    active = stored;
    return true;
}

bool slots_find(uint8_t image[LARGEST_IMAGE_BYTES])
{
    struct stored_image first, second;
    active_slot = NO_SLOT;
    active = (struct stored_image){0, 0, 0};
    writing.stage = REST;
    read_header(0, &first);
    read_header(1, &second);
    uint8_t newer = second.sequence > first.sequence;
    return load_if_good(newer, image) || load_if_good(!newer, image);
}

struct stored_image slots_active(void)
{
    return active;
}

uint8_t slots_read(uint16_t offset)
{
    return port_eeprom_read(address_of(active_slot, SLOT_HEADER_BYTES + offset));
}

void slots_begin_write(const uint8_t *image, uint16_t length, uint16_t crc)
{
    writing.slot = active_slot == 0;
    writing.image = image;
    writing.stored.sequence = active.sequence + 1;
    writing.stored.length = length;
    writing.stored.crc = crc;
    make_header(writing.header, &writing.stored);
    writing.left = 1;
    writing.stage = INVALIDATE_HEADER;
}

bool slots_are_writing(void)
{
    return writing.stage != REST;
}

/* The byte that must stand at the beginning of this stage's part of the slot plus `index`. */
static uint8_t wanted_byte(uint16_t index)
{
    switch (writing.stage) {
    case INVALIDATE_HEADER:
        return ERASED;
    case WRITE_IMAGE:
    case CHECK_IMAGE:
        return writing.image[index];
    default:
        return writing.header[index];
    }
}

/* Goes on to the next stage; after the last one the slot written is the active one. */
static enum write_progress next_stage(void)
{
    if (writing.stage == CHECK_HEADER) {
        writing.stage = REST;
        active_slot = writing.slot;
        active = writing.stored;
        return WRITTEN;
    }
    writing.stage++;
    bool is_image = writing.stage == WRITE_IMAGE || writing.stage == CHECK_IMAGE;
    writing.left = is_image ? writing.stored.length : SLOT_HEADER_BYTES;
    return WRITING;
}

enum write_progress slots_poll(void)
{
    if (writing.stage == REST) {
        return NOT_WRITING;
    }
    if (port_eeprom_is_busy()) {
        return WRITING;
    }
    if (writing.left == 0) {
        return next_stage();
    }
    writing.left--;
    bool is_image = writing.stage == WRITE_IMAGE || writing.stage == CHECK_IMAGE;
    uint16_t address = address_of(writing.slot, (uint16_t)((is_image ? SLOT_HEADER_BYTES : 0) + writing.left));
    uint8_t wanted = wanted_byte(writing.left);
    if (port_eeprom_read(address) == wanted) {
        return WRITING; /* nothing to do: a byte that stands there already isn't worn out */
    }
    if (writing.stage == CHECK_IMAGE || writing.stage == CHECK_HEADER) {
        writing.stage = REST;
        return WRITE_FAILED;
    }
    port_eeprom_write(address, wanted);
    return WRITING;
}
