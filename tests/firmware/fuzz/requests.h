/* Making requests, by chance. */
#ifndef STEPRAMP_REQUESTS_H
#define STEPRAMP_REQUESTS_H

#include <stdint.h>

#include "stepramp/protocol/frame.h"

/* Of the last request. */
extern uint8_t tag;

/* Makes a frame of a request. Returns its length. */
uint8_t make_frame(uint8_t frame[LONGEST_FRAME]);

/* Writes a number at a place. Returns the place after it. */
uint8_t put_u16(uint8_t *body, uint8_t at, uint32_t value);

#endif
