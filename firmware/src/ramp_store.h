/* The two ramps of a controller: the active one, with which moves are played and which EEPROM keeps, and the staged
 * one, an image in RAM on its way to become active. */
#ifndef STEPRAMP_RAMP_STORE_H
#define STEPRAMP_RAMP_STORE_H

#include <stdbool.h>
#include <stdint.h>

#include "ramp.h"

#ifdef __cplusplus
extern "C" {
#endif

enum staging { NOTHING_BEGUN, RECEIVING, CHECKED };

struct staged_image {
    uint8_t bytes[LARGEST_IMAGE_BYTES];
    uint16_t length;   /* [bytes] announced */
    uint16_t received; /* [bytes] */
    uint16_t crc;      /* announced */
    uint16_t received_crc;
    enum staging staging;
};

/* At start: makes the stored ramp active, if there is one. */
void ramp_store_begin(void);

/* Goes on with writing, by a little. */
void ramp_store_poll(void);

/* NULL when there is none. */
const struct ramp *ramp_store_active(void);

/* The staged image; `staging` is for the caller to set to CHECKED. */
struct staged_image *ramp_store_staged(void);

void ramp_store_stage(uint16_t length, uint16_t crc);

/* Adds bytes to the staged image; there must be room for them. */
void ramp_store_receive(const uint8_t *bytes, uint8_t count);

/* Begins to write the staged image, which must be checked. When that has gone well it becomes the active ramp. */
void ramp_store_commit(void);

/* Neither ramp may be changed or used now. */
bool ramp_store_is_writing(void);
bool ramp_store_last_write_failed(void);

#ifdef __cplusplus
}
#endif

#endif
