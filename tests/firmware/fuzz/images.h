/* The ramp images that are delivered. */
#ifndef STEPRAMP_IMAGES_H
#define STEPRAMP_IMAGES_H

#include <stdint.h>

#include "boards/avr/avr_limits.h"
#include "stepramp/store/ramp_keeper.h"

struct image {
    uint16_t length; /* 0: none */
    uint8_t bytes[LARGEST_IMAGE_BYTES];
};

/* Reads them from texts in hexadecimal. */
void images_read(char **texts, int count);

/* One of them, by chance. */
const struct image *some_image(void);

uint16_t crc_of(const uint8_t *bytes, uint16_t length);

#endif
