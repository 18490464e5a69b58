/* The answers to requests: each does what one asks for, and writes its reply. */
#ifndef STEPRAMP_ANSWERS_H
#define STEPRAMP_ANSWERS_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Where the fields of a message's header lie. */
enum { KIND_AT = 0, SESSION_AT = 1, TAG_AT = 3 };

enum { NO_SESSION = 0 };

extern uint16_t stepramp_session;

/* The request answered last. */
extern uint8_t stepramp_answered_kind, stepramp_answered_tag;

/* Its answer gave way to a stop that has come in: it is begun anew, should that turn out to be none. */
extern bool stepramp_answer_gave_way;

/* Answers a request, whose body has this length: writes the message of the reply. */
void answer(const uint8_t *message, uint8_t length);

bool answer_is_of_session(const uint8_t *message);

#ifdef __cplusplus
}
#endif

#endif
