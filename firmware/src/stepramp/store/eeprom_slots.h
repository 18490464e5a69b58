/* Two slots of EEPROM, each for the settings and a ramp image. One is active. What is stored goes to the other one, a
 * byte at a time, its header last; rolling back makes the other one the newer again by its header alone. A power cut at
 * any moment leaves a whole old content active or a whole new one. */
#ifndef STEPRAMP_EEPROM_SLOTS_H
#define STEPRAMP_EEPROM_SLOTS_H

#include <stdbool.h>
#include <stdint.h>

#include "stepramp/edge/board_limits.h"
#include "stepramp/store/driver_settings.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { SLOT_BYTES = 512, SLOT_HEADER_BYTES = 12 };

/* What a slot holds, as it lies there, and its only copy in RAM: that is loaded and stored. The board defines it, as
 * large as its images may be. */
struct slot_content {
    struct settings settings; /* packed */
    uint8_t image[];
};
extern struct slot_content stepramp_slot_content;
extern uint16_t stepramp_slot_image_length; /* [bytes] of the image in RAM, or announced for it */

enum slot_choice { ACTIVE_SLOT, PREVIOUS_SLOT };

/* At start: makes the newest slot active whose header, CRC, settings and ramp are good, and loads it. Returns false
 * when there is none; then the content in RAM means nothing. */
bool eeprom_slots_find(void);

/* The active slot's number: 1 for the first one ever written, then one more each time; 0: none. */
uint32_t eeprom_slots_sequence(void);

/* A slot holds something good. The length of its ramp image then [bytes], else 0. */
bool eeprom_slots_hold(enum slot_choice choice);
uint16_t eeprom_slots_image_length(enum slot_choice choice);

/* A byte of a slot's ramp image, and the CRC of the whole, which takes some milliseconds. */
uint8_t eeprom_slots_read(enum slot_choice choice, uint16_t offset);
uint16_t eeprom_slots_image_crc(enum slot_choice choice);

/* Loads a slot. Returns false when it holds nothing, or nothing good: it holds nothing then from now on. */
bool eeprom_slots_load(enum slot_choice choice);

/* The active slot's image alone: the settings in RAM stay as they are. */
bool eeprom_slots_load_image(void);

/* The settings in RAM are those that hold as long as nothing is stored. */
void eeprom_slots_use_defaults(void);

/* Begins to store the content in RAM, which must stay as it is until the write has ended. */
void eeprom_slots_begin_write(void);

/* Begins to make the previous slot the active one. It must be in RAM, and stay there until the write has ended. */
void eeprom_slots_begin_roll_back(void);

enum write_progress { NOT_WRITING, WRITING, WRITTEN, WRITE_FAILED };

/* Goes on with a write by at most one byte, without waiting. Says WRITTEN or WRITE_FAILED once. */
enum write_progress eeprom_slots_poll(void);

bool eeprom_slots_are_writing(void);

#ifdef __cplusplus
}
#endif

#endif
