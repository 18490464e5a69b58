/* The controller: answers requests, one at a time, and sends reports and traces. A port hands it the bytes that come
 * in, sends the frames that go out (port.h), and calls controller_poll in each round of its main loop. */
#ifndef STEPRAMP_CONTROLLER_H
#define STEPRAMP_CONTROLLER_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* At start: loads what is stored. Nothing moves. */
void controller_begin(void);

/* Takes a byte from the serial port. */
void controller_receive(uint8_t byte);

/* Goes on, by a little, with what takes long: moves, writing a ramp, reports. Returns false while frames keep
 * coming: then a round should take few bytes. */
bool controller_poll(void);

#ifdef __cplusplus
}
#endif

#endif
