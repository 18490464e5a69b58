#include "stepramp/store/eeprom_slots.h"

#include <string.h>

#include "stepramp/edge/board.h"
#include "stepramp/edge/out_of_line.h"
#include "stepramp/protocol/frame.h"
#include "stepramp/protocol/message.h"
#include "stepramp/store/ramp_image.h"

enum { MAGIC = 0x53, ERASED = 0xFF };

/* The first format has the settings of the outputs only, the second one those of inputs, too, the third one soft limits. */
enum { FORMAT_OF_OUTPUTS = 2, FORMAT_WITH_INPUTS = 3, FORMAT_WITH_LIMITS = 4, SLOT_FORMAT = HAS_INPUTS ? FORMAT_WITH_LIMITS : FORMAT_OF_OUTPUTS };

/* Where the parts of a header lie. */
enum header_offset { AT_MAGIC = 0, AT_FORMAT = 1, AT_LENGTH = 2, AT_SEQUENCE = 4, AT_CRC = 8, AT_HEADER_CRC = 10 };

/* What is still to be written, each from its last byte back to its first, so that the very last byte is the first of
 * the header, without which a slot is none. Rolling back begins with WRITE_HEADER. */
enum stage { REST = 0, WRITE_HEADER = 1, WRITE_CONTENT = 2, INVALIDATE_HEADER = 3 };

uint16_t stepramp_slot_image_length;

/* What is known of the slots: a bit for each enum slot_choice that holds something good, and what follows. */
enum { HAS_ACTIVE = 1 << ACTIVE_SLOT, HAS_PREVIOUS = 1 << PREVIOUS_SLOT, HAS_BEEN_WRITTEN = 4 };

static uint8_t active_slot; /* 0 or 1 */
static uint8_t known;       /* HAS_BEEN_WRITTEN: the next byte, which is yet to be checked */
static uint8_t stage;       /* enum stage */
static bool rolls_back;     /* only the header is written */
static uint16_t left;       /* bytes left in this stage */

static uint8_t slot_of(enum slot_choice choice)
{
    return active_slot ^ choice;
}

static uint16_t address_of(uint8_t slot, uint16_t offset)
{
    return slot == 0 ? offset : (uint16_t)(SLOT_BYTES + offset);
}

/* Reads so many bytes of a slot, from this offset on. */
static OUT_OF_LINE void read_bytes(uint8_t slot, uint16_t offset, uint8_t *bytes, uint16_t count)
{
    for (uint16_t address = address_of(slot, offset); count != 0; count--) {
        *bytes++ = board_eeprom_read(address++);
    }
}

/* ---- headers ---- */

/* Reads a slot's header. Returns false when it is none. */
static bool read_header(uint8_t slot, uint8_t header[SLOT_HEADER_BYTES])
{
    read_bytes(slot, 0, header, SLOT_HEADER_BYTES);
    return header[AT_MAGIC] == MAGIC && (uint8_t)(header[AT_FORMAT] - FORMAT_OF_OUTPUTS) <= SLOT_FORMAT - FORMAT_OF_OUTPUTS;
}

/* So many bytes of a slot of this format are settings. */
static uint8_t settings_in(uint8_t format)
{
#if HAS_INPUTS
    if (format != FORMAT_OF_OUTPUTS) {
        return format == FORMAT_WITH_INPUTS ? SETTINGS_BYTES : STORED_SETTINGS_BYTES;
    }
#else
    (void)format;
#endif
    return OUTPUT_SETTINGS_BYTES;
}

/* The sequence number of a slot. Rolling back changes it, and the header's CRC, in place. When the power was cut
 * meanwhile, they don't go together, but the content is whole and has its own CRC: then the slot counts as older than
 * any other (0). */
static uint32_t sequence_of(uint8_t slot)
{
    uint8_t header[SLOT_HEADER_BYTES];
    bool is_whole = read_header(slot, header) && read_u16(header + AT_HEADER_CRC) == frame_crc16(header, AT_HEADER_CRC);
    return is_whole ? read_u32(header + AT_SEQUENCE) : 0;
}

/* It is read whenever it is asked for, as room is scarcer than time: so is all else that a header says. */
uint32_t eeprom_slots_sequence(void)
{
    if (!eeprom_slots_hold(ACTIVE_SLOT)) {
        return 0;
    }
    uint32_t sequence = sequence_of(active_slot);
    return sequence == 0 ? 1 : sequence; /* 0 would say that there is none */
}

/* ---- contents ---- */

static uint8_t *content_bytes(void)
{
    return (uint8_t *)&stepramp_slot_content;
}

void eeprom_slots_use_defaults(void)
{
    settings_set_defaults(&stepramp_slot_content.settings);
#if !IS_LITTLE_ENDIAN
    struct settings settings = stepramp_slot_content.settings;
    settings_pack(&settings, content_bytes());
#endif
}

/* Loads the slot if it holds something good, or all but its settings. What is new in the settings since its format gets its
 * default. */
static bool load(uint8_t slot, bool has_settings)
{
    uint8_t header[SLOT_HEADER_BYTES];
    uint16_t length = 0;
    if (read_header(slot, header)) {
        length = read_u16(header + AT_LENGTH);
    }
    uint8_t settings_length = settings_in(header[AT_FORMAT]);
    if (length <= settings_length || length > settings_length + board_limit(LIMIT_IMAGE_BYTES)) {
        return false;
    }
    stepramp_slot_image_length = (uint16_t)(length - settings_length);
    if (has_settings) {
        eeprom_slots_use_defaults();
    }
    uint16_t crc = CRC16_START, address = address_of(slot, SLOT_HEADER_BYTES);
    for (uint16_t i = 0; i < length; i++) {
        uint8_t byte = board_eeprom_read(address++);
        crc = frame_crc16_update(crc, byte);
        if (i >= settings_length) {
            stepramp_slot_content.image[i - settings_length] = byte;
        } else if (has_settings) {
            content_bytes()[i] = byte;
        }
    }
    return crc == read_u16(header + AT_CRC) && settings_check(content_bytes()) == SETTINGS_BYTES &&
           ramp_image_check(stepramp_slot_content.image, stepramp_slot_image_length).good;
}

static bool load_known(enum slot_choice choice, bool has_settings)
{
    uint8_t bit = choice == ACTIVE_SLOT ? HAS_ACTIVE : HAS_PREVIOUS;
    known &= (uint8_t)~bit;
    if (!load(slot_of(choice), has_settings)) {
        return false;
    }
    known |= bit;
    return true;
}

bool eeprom_slots_load(enum slot_choice choice)
{
    return load_known(choice, true);
}

bool eeprom_slots_load_image(void)
{
    return load_known(ACTIVE_SLOT, false);
}

/* Loads the older slot first, only to know whether it is good, then the newer one; without that, the older one is the
 * active one. */
bool eeprom_slots_find(void)
{
    stage = REST;
    active_slot = sequence_of(1) > sequence_of(0);
    eeprom_slots_load(PREVIOUS_SLOT);
    if (eeprom_slots_load(ACTIVE_SLOT)) {
        return true;
    }
    active_slot = slot_of(PREVIOUS_SLOT);
    known = 0;
    return eeprom_slots_load(ACTIVE_SLOT);
}

bool eeprom_slots_hold(enum slot_choice choice)
{
    return (known & (choice == ACTIVE_SLOT ? HAS_ACTIVE : HAS_PREVIOUS)) != 0;
}

uint16_t eeprom_slots_image_length(enum slot_choice choice)
{
    uint8_t header[SLOT_HEADER_BYTES];
    read_header(slot_of(choice), header);
    return eeprom_slots_hold(choice) ? (uint16_t)(read_u16(header + AT_LENGTH) - settings_in(header[AT_FORMAT])) : 0;
}

uint8_t eeprom_slots_read(enum slot_choice choice, uint16_t offset)
{
    uint8_t slot = slot_of(choice);
    uint8_t settings_length = settings_in(HAS_INPUTS ? board_eeprom_read(address_of(slot, AT_FORMAT)) : SLOT_FORMAT);
    return board_eeprom_read(address_of(slot, (uint16_t)(SLOT_HEADER_BYTES + settings_length + offset)));
}

uint16_t eeprom_slots_image_crc(enum slot_choice choice)
{
    uint16_t crc = CRC16_START, length = eeprom_slots_image_length(choice);
    for (uint16_t i = 0; i < length; i++) {
        crc = frame_crc16_update(crc, eeprom_slots_read(choice, i));
    }
    return crc;
}

/* ---- writing ---- */

static uint16_t content_length(void)
{
    return STORED_SETTINGS_BYTES + stepramp_slot_image_length;
}

static OUT_OF_LINE void begin_stage(uint8_t next)
{
    stage = next;
    left = next == WRITE_CONTENT ? content_length() : next == WRITE_HEADER ? SLOT_HEADER_BYTES : 1;
}

void eeprom_slots_begin_roll_back(void)
{
    known &= HAS_ACTIVE;
    rolls_back = true;
    begin_stage(WRITE_HEADER);
}

void eeprom_slots_begin_write(void)
{
    eeprom_slots_begin_roll_back();
    rolls_back = false;
    begin_stage(INVALIDATE_HEADER);
}

bool eeprom_slots_are_writing(void)
{
    return stage != REST;
}

/* A byte of the header to be written; rolling back, one that tells of the same content, in its own format. It takes a while, as it needs the content's CRC, but so does writing a byte. */
static uint8_t header_byte(uint8_t index)
{
    uint8_t header[SLOT_HEADER_BYTES];
    read_header(slot_of(PREVIOUS_SLOT), header);
    if (!rolls_back) {
        header[AT_MAGIC] = MAGIC;
        header[AT_FORMAT] = SLOT_FORMAT;
        write_u16(header + AT_LENGTH, content_length());
        write_u16(header + AT_CRC, frame_crc16(content_bytes(), content_length()));
    }
    write_u32(header + AT_SEQUENCE, eeprom_slots_sequence() + 1);
    write_u16(header + AT_HEADER_CRC, frame_crc16(header, AT_HEADER_CRC));
    return header[index];
}

static uint8_t content_byte(uint16_t index)
{
    return stage == WRITE_HEADER    ? header_byte((uint8_t)index)
           : stage == WRITE_CONTENT ? content_bytes()[index]
                                    : ERASED;
}

/* Goes on to the next stage; after the last one the slot written is the active one. */
static enum write_progress next_stage(void)
{
    begin_stage((uint8_t)(stage - 1));
    if (stage != REST) {
        return WRITING;
    }
    active_slot = slot_of(PREVIOUS_SLOT);
    known = eeprom_slots_hold(ACTIVE_SLOT) ? HAS_ACTIVE | HAS_PREVIOUS : HAS_ACTIVE;
    return WRITTEN;
}

enum write_progress eeprom_slots_poll(void)
{
    if (stage == REST) {
        return NOT_WRITING;
    }
    if (board_eeprom_is_busy()) {
        return WRITING;
    }
    if (left == 0) {
        return next_stage();
    }
    uint16_t index = (uint16_t)(left - 1);
    uint16_t address = address_of(slot_of(PREVIOUS_SLOT), stage == WRITE_CONTENT ? SLOT_HEADER_BYTES + index : index);
    uint8_t byte = content_byte(index);
    if (board_eeprom_read(address) == byte) { /* a byte that stands there already isn't worn out */
        known &= (uint8_t)~HAS_BEEN_WRITTEN;
        left = index;
    } else if ((known & HAS_BEEN_WRITTEN) != 0) {
        stage = REST;
        return WRITE_FAILED;
    } else {
        board_eeprom_write(address, byte);
        known |= HAS_BEEN_WRITTEN;
    }
    return WRITING;
}
