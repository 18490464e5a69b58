/* What is to be known of each kind of request: who may ask, when, and how long it is. */
#ifndef STEPRAMP_REQUEST_RULES_H
#define STEPRAMP_REQUEST_RULES_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Those that would disturb a move or a write wait for its end; but what may come in flight changes what a motor does while
 * it moves. */
enum { FROM_ANYONE = 0x10, DISTURBS = 0x20, IN_FLIGHT = 0x40 };

/* A set of these, and of what is to be known of its length; 0: there is no such request. */
uint8_t request_rules(uint8_t kind);

bool request_length_is_good(uint8_t kind, uint8_t known, const uint8_t *body, uint8_t length);

/* Refuses what would disturb a move or a write. Returns false when it has refused. */
bool request_is_free(uint8_t known);

#ifdef __cplusplus
}
#endif

#endif
