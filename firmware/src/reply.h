/* The reply to the request in hand: written field by field, then sent as a frame, again if need be. */
#ifndef STEPRAMP_REPLY_H
#define STEPRAMP_REPLY_H

#include <stdbool.h>
#include <stdint.h>

#include "message.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Begins a reply with its header. */
void reply_begin(uint8_t request_kind, uint16_t session, uint8_t tag);

void reply_u8(uint8_t value);
void reply_u16(uint16_t value);
void reply_u32(uint32_t value);

/* Begins the body of an accepted request. */
void reply_ok(void);

/* Writes the whole body of a refused one. */
void reply_refusal(enum status status, uint16_t detail);

/* Makes the reply a frame. */
void reply_end(void);

/* Sends the frame, which may have been sent before. */
void reply_send(void);
bool reply_is_going_out(void);

/* Gives the next byte to send. Returns false when there is none. */
bool reply_next_byte(uint8_t *byte);

#ifdef __cplusplus
}
#endif

#endif
