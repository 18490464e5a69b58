/* The controller: answers requests, one at a time, and sends reports and traces. A board hands it the bytes that come
 * in, sends the frames that go out (board.h), and calls controller_poll in each round of its main loop. */
#ifndef STEPRAMP_CONTROLLER_H
#define STEPRAMP_CONTROLLER_H

#include <stdbool.h>
#include <stdint.h>

#include "stepramp/protocol/request.h"

#ifdef __cplusplus
extern "C" {
#endif

/* At start: loads what is stored. Nothing moves. */
void controller_begin(void);

/* Does what the request says that has come in, of this length, or lets it wait. */
void controller_obey(uint8_t length);

/* Takes a byte from the serial port. Here, as it costs a third less so. */
static inline void controller_receive(uint8_t byte)
{
    uint8_t length = request_receive(byte);
    if (length != 0) {
        controller_obey(length);
    }
}

/* Goes on, by a little, with what takes long: moves, writing a ramp, reports. */
void controller_poll(void);

#ifdef __cplusplus
}
#endif

#endif
