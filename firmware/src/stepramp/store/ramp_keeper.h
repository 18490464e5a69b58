/* The ramp image and the settings in use, and what is stored of them. There is one image in RAM: the stored one, one
 * that is on trial, or one that is being delivered. While one is delivered none can be played, so that a move brings
 * the stored one back first. */
#ifndef STEPRAMP_RAMP_KEEPER_H
#define STEPRAMP_RAMP_KEEPER_H

#include <stdbool.h>
#include <stdint.h>

#include "stepramp/edge/board_limits.h"
#include "stepramp/store/driver_settings.h"
#include "stepramp/store/ramp_image.h"

#ifdef __cplusplus
extern "C" {
#endif

/* At start: uses what is stored, or no ramp and the default settings. */
void ramp_keeper_begin(void);

/* Goes on with writing, by a little. */
void ramp_keeper_poll(void);

/* ---- what is in use ---- */

enum ramp_in_use { NO_RAMP = 0, STORED_RAMP = 1, RAMP_ON_TRIAL = 2 };

/* While a ramp is delivered: the stored one. */
enum ramp_in_use ramp_keeper_in_use(void);

/* CRC of the image in use and its number of axes; 0 without one. */
uint16_t ramp_keeper_crc(void);
uint8_t ramp_keeper_axes(void);

/* FLAG_WRITE_FAILED and FLAG_ON_TRIAL, of status: the last write has failed; the ramp or the settings in use are not
 * the stored ones. */
uint8_t ramp_keeper_flags(void);

/* Every k-th step of this axis gives about 1000 values a second at slew speed. 1 while a ramp is delivered. */
uint16_t ramp_keeper_trace_every(uint8_t axis);

/* Sees to it that the machine has the ramp in use, dropping what was delivered. Returns false when there is none. */
bool ramp_keeper_make_ready(void);

/* The settings in use, packed. */
const uint8_t *ramp_keeper_settings(void);

/* Exchanges the first settings, packed, for others, which are to be checked and then used, or exchanged back: without a copy, for
 * which the stack has no room. */
void ramp_keeper_exchange_settings(uint8_t *bytes, uint8_t count);

/* Uses settings that have been exchanged and checked, from now on, in RAM, and returns SETTINGS_BYTES. Not those by which an
 * input would be an emergency stop that is active already: by a wrong level nobody could release it. They are exchanged back;
 * returns where that one's role lies among them. */
uint8_t ramp_keeper_use_settings(uint8_t *before, uint8_t count);

#if HAS_INPUTS
/* The same of an axis' soft limits. */
void ramp_keeper_use_limits(uint8_t axis, const uint8_t bytes[SOFT_LIMITS_BYTES]);
#endif

/* ---- delivery ---- */

/* Begins a delivery; the length is at most the board's limit. */
void ramp_keeper_deliver(uint16_t length, uint16_t crc);

/* A delivery has begun, and has neither been used nor dropped. */
bool ramp_keeper_is_delivered_to(void);

uint16_t ramp_keeper_received(void); /* [bytes]; 0 without a delivery */

/* Puts a byte behind what has been received: it only counts when ramp_keeper_receive says so. Until then it is in
 * nobody's way, so that the bytes of a request can go where they belong before that has come to its end. */
void ramp_keeper_put(uint8_t index, uint8_t byte);

/* Adds so many of these bytes to the delivery, at this offset. Returns STATUS_OK, or why not. */
uint8_t ramp_keeper_receive(uint16_t offset, uint8_t count, uint16_t *detail);

/* Checks a delivery that is whole. Returns STATUS_OK, or why it can't be used. */
uint8_t ramp_keeper_check(uint16_t *detail);

/* Uses the ramp that was checked, in RAM. Returns false when there is none. */
bool ramp_keeper_try(void);

/* Begins to store the ramp that was checked, or is in use, with the settings. Returns false when there is none. */
bool ramp_keeper_commit(void);

/* Drops what is delivered or on trial; when there is nothing of the kind begins to make the previous ramp the active
 * one again. Returns false when there is no previous one. */
bool ramp_keeper_roll_back(void);

/* What is in RAM: the delivery as far as it goes, or the ramp in use. */
uint16_t ramp_keeper_ram_length(void);

#ifdef __cplusplus
}
#endif

#endif
