/* What comes in over the serial port, byte by byte: requests. One is kept until it has been answered; of one that comes in
 * beside it only as much as a stop or halt has. */
#ifndef STEPRAMP_REQUEST_H
#define STEPRAMP_REQUEST_H

#include <stdbool.h>
#include <stdint.h>

#include "stepramp/edge/board_limits.h"
#include "stepramp/protocol/message.h"
#include "stepramp/store/driver_settings.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { VALUE_BYTES = 4 };

/* A line of all axes is the longest request of which all bytes are kept; with inputs those of settings, and homing, are longer. Those
 * of a delivery go to the ramp store. */
enum { KEPT_BYTES = MESSAGE_HEADER_BYTES + (HAS_INPUTS ? SETTINGS_BYTES : 2 + VALUE_BYTES * AXES), DATA_AT = MESSAGE_HEADER_BYTES + 2 };

/* The slow approach's interval and the steps to back off, of homing, between the mask and the values. */
enum { HOMING_BYTES = 6 };

/* A stop or halt, the only request that is looked at while another one waits. */
enum { URGENT_BYTES = MESSAGE_HEADER_BYTES + 1 };

extern struct requests {
    uint8_t waiting_length; /* of the one in `kept` that waits to be answered; 0: none does */
    bool is_beside;         /* the one that comes in, into `urgent`: another one waited when it began */
    uint8_t kept[KEPT_BYTES], urgent[URGENT_BYTES];
} stepramp_requests;

/* Takes a byte. Returns the length of the request that it ends, or 0. */
uint8_t request_receive(uint8_t byte);

#ifdef __cplusplus
}
#endif

#endif
