#include "images.h"

#include <stdio.h>

#include "chance.h"
#include "must.h"
#include "stepramp/protocol/frame.h"

enum { MOST_IMAGES = 16 };

static struct image images[MOST_IMAGES];
static unsigned image_count;

void images_read(char **texts, int count)
{
    must(count <= MOST_IMAGES, "too many images");
    for (image_count = 0; image_count < (unsigned)count; image_count++) {
        struct image *image = &images[image_count];
        unsigned value;
        while (sscanf(texts[image_count] + 2 * image->length, "%2x", &value) == 1) {
            image->bytes[image->length++] = (uint8_t)value;
        }
    }
}

const struct image *some_image(void)
{
    return &images[below(image_count)];
}

uint16_t crc_of(const uint8_t *bytes, uint16_t length)
{
    uint16_t crc = CRC16_START;
    for (uint16_t i = 0; i < length; i++) {
        crc = frame_crc16_update(crc, bytes[i]);
    }
    return crc;
}
