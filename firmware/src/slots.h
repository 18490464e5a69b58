/* Two slots of EEPROM for ramp images, of which one is active. A write goes to the other one, a byte at a time, its
 * header last: a power cut at any moment leaves the old image or the new one. */
#ifndef STEPRAMP_SLOTS_H
#define STEPRAMP_SLOTS_H

#include <stdbool.h>
#include <stdint.h>

#include "limits.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { SLOT_BYTES = 512, SLOT_HEADER_BYTES = 12 };

/* What is known of the active slot. Without one all is 0. */
struct stored_image {
    uint32_t sequence; /* 1 for the first image ever written, then one more for each */
    uint16_t length;   /* [bytes] */
    uint16_t crc;
};

struct stored_image slots_active(void);

/* At start: makes the newest slot active whose header, CRC and content are good, and leaves its image in `image`.
 * Returns false when there is none. */
bool slots_find(uint8_t image[LARGEST_IMAGE_BYTES]);

/* A byte of the active image. */
uint8_t slots_read(uint16_t offset);

/* Begins to write an image, which must stay as it is until the write has ended. */
void slots_begin_write(const uint8_t *image, uint16_t length, uint16_t crc);

enum write_progress { NOT_WRITING, WRITING, WRITTEN, WRITE_FAILED };

/* Goes on with a write by at most one byte, without waiting. Says WRITTEN or WRITE_FAILED once. */
enum write_progress slots_poll(void);

bool slots_are_writing(void);

#ifdef __cplusplus
}
#endif

#endif
