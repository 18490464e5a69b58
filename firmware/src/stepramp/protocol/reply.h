/* What goes out: the reply to the request in hand, kept for when it is asked for again, and one notice, a report or a
 * trace, at a time. Either is written field by field and then becomes a frame. A reply goes before a notice. */
#ifndef STEPRAMP_REPLY_H
#define STEPRAMP_REPLY_H

#include <stdbool.h>
#include <stdint.h>

#include "stepramp/edge/board_limits.h"
#include "stepramp/protocol/message.h"

/* A piece of a ramp image that has been read: status, length of the whole, and bytes. */
enum { LONGEST_REPLY_BYTES = MESSAGE_HEADER_BYTES + 3 + MOST_DATA_BYTES };

/* A report of all axes: time and states, then position and interval of each. A trace's notice is no longer. */
enum { LONGEST_NOTICE_BYTES = MESSAGE_HEADER_BYTES + 3 + 8 * AXES };

#ifdef __cplusplus
extern "C" {
#endif

/* Begins the reply to the request with this header. It says that all is well; the fields that follow belong to it. */
void reply_begin(const uint8_t request_header[MESSAGE_HEADER_BYTES]);

/* Begins a notice; only when the last one has gone. It is no longer than LONGEST_NOTICE_BYTES. */
void notice_begin(uint8_t kind, uint16_t session, uint8_t tag);

/* Goes on with a notice that has been begun, whose message has so many bytes by now. */
void notice_go_on(uint8_t length);

void reply_u8(uint8_t value);
void reply_u16(uint16_t value);
void reply_u32(uint32_t value);
void reply_bytes(const uint8_t *bytes, uint8_t count);

/* Numbers of 32 bits, with a sign or without one, that lie one after the other in memory. */
void reply_numbers(const void *numbers, uint8_t count);

/* Makes the reply that of a refused request, whatever has been written of it. */
void reply_refusal(uint8_t status, uint16_t detail);

/* In the same way, unless the status says that all is well. */
void reply_status(uint8_t status, uint16_t detail);

/* Makes the reply a frame. */
void reply_end(void);

/* Sends the frame, which may have been sent before. */
void reply_send(void);
bool reply_is_going_out(void);

/* Makes the notice a frame and sends it. */
void notice_send(void);
bool notice_is_going_out(void);

/* Drops the notice, unless a part of it has gone already. */
void notice_drop(void);

/* Ends what is going out, so that the next reply follows at once: a frame that has begun is cut, a reply that waits is
 * dropped. */
void reply_cut(void);

/* To be called in each round of the main loop: goes on with the next frame when one has gone. */
void reply_poll(void);

#ifdef __cplusplus
}
#endif

#endif
