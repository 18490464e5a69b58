/* The ramp image: the ramps of a machine's axes as they are sent and stored. Its bytes are described in
 * docs/serial_protocol.md. Moves are played from it as it lies there. */
#ifndef STEPRAMP_RAMP_IMAGE_H
#define STEPRAMP_RAMP_IMAGE_H

#include <stdbool.h>
#include <stdint.h>

#include "stepramp/motion/ramp_cursor.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Where an image is bad, when it is not in a ramp or not in a ramp's segment. */
#define BAD_IMAGE_HEADER 0xFFu
#define BAD_RAMP_HEADER 0xFFu

/* What a check of an image found. */
struct image_check {
    bool good;
    uint16_t bad; /* high byte: the first bad ramp, or BAD_IMAGE_HEADER; low: its bad segment, or BAD_RAMP_HEADER */
};

/* Checks an image, wholly, without changing anything. */
struct image_check ramp_image_check(const uint8_t *image, uint16_t length);

enum ramp_kind { RAMP_OF_SEGMENTS = 0, RAMP_BY_FORMULA = 1 };

/* A ramp of an image that has been checked. */
struct image_ramp {
    uint8_t kind;            /* enum ramp_kind */
    uint32_t slew_interval;  /* [ticks] */
    struct packed_list up;   /* of segments, from the slow end */
    struct packed_list down; /* likewise */
    const uint8_t *formula;  /* its constants; means nothing of a ramp of segments, as the lists do of a formula */
};

/* Where an image says which clock it is for, and how many axes and ramps it has. */
enum { RAMP_IMAGE_CLOCK_AT = 1, RAMP_IMAGE_AXES_AT = 2, RAMP_IMAGE_RAMPS_AT = 3, RAMP_IMAGE_FAST_CLOCK = 1 };

static inline uint8_t ramp_image_axes(const uint8_t *image)
{
    return image[RAMP_IMAGE_AXES_AT];
}

static inline uint8_t ramp_image_ramps(const uint8_t *image)
{
    return image[RAMP_IMAGE_RAMPS_AT];
}

/* Its ticks are those of the fast clock. */
static inline bool ramp_image_is_fast(const uint8_t *image)
{
    return (image[RAMP_IMAGE_CLOCK_AT] & RAMP_IMAGE_FAST_CLOCK) != 0;
}

/* The ramp of an axis, and only its slew interval [ticks]. */
struct image_ramp ramp_image_ramp(const uint8_t *image, uint8_t axis);
uint32_t ramp_image_slew_interval(const uint8_t *image, uint8_t axis);

#ifdef __cplusplus
}
#endif

#endif
