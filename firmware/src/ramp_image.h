/* The ramp image: a ramp as it is sent and stored. Its bytes are described in docs/serial_protocol.md. */
#ifndef STEPRAMP_RAMP_IMAGE_H
#define STEPRAMP_RAMP_IMAGE_H

#include <stdbool.h>
#include <stdint.h>

#include "ramp.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where an image is bad when it isn't a segment. */
#define BAD_IMAGE_HEADER 0xFFFFu

/* What a check of an image found. */
struct image_check {
    bool good;
    uint16_t bad_segment; /* index of the first bad segment, one past the last when bytes follow it, or the header */
    uint8_t up_segments;
    uint8_t down_segments; /* as many as up when the image says that they are the same list */
};

/* Checks an image, wholly, without changing anything. */
struct image_check ramp_image_check(const uint8_t *image, uint16_t length);

/* Reads an image from its first segment to its last. */
struct image_reader {
    const uint8_t *image;
    const uint8_t *next;
    const uint8_t *end;
    struct segment segment; /* the last one read */
    uint32_t first;         /* [ticks] its first interval */
    uint8_t read;           /* segments read so far */
};

/* Begins to unpack an image that has been checked and found good. */
void ramp_image_begin_unpacking(struct image_reader *reader, const uint8_t *image, uint16_t length, struct ramp *ramp);

/* Unpacks one segment: a few hundred cycles. Returns false when the ramp is complete. */
bool ramp_image_unpack_segment(struct image_reader *reader, struct ramp *ramp);

#ifdef __cplusplus
}
#endif

#endif
