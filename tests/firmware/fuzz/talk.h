/* Sending to the controller, and listening to it. */
#ifndef STEPRAMP_TALK_H
#define STEPRAMP_TALK_H

#include <stddef.h>
#include <stdint.h>

extern uint16_t session;

/* Requests of each kind that were answered, repeats not counted, and those of them that were accepted. */
extern long counts[256], accepted[256];

/* Sends bytes, and looks at the answer to each good frame among them. */
void talk_send(const uint8_t *bytes, size_t count);

void talk_let_time_pass(void);

#endif
