/* The trace of a move: the timer's value at every k-th step of one axis, on its way to the client. What the serial line
 * can't carry is dropped, and shows as a gap in the numbers of the steps. All of it belongs to the main loop. */
#ifndef STEPRAMP_TRACE_H
#define STEPRAMP_TRACE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Traces every k-th step of each move of an axis that begins from now on, or nothing more. */
void trace_arm(uint8_t axis, uint16_t every);
void trace_off(void);

/* Makes the next frame when it is time for one and the line has room. Returns true when it has made one. */
bool trace_poll(uint16_t session, uint16_t now_ms);

/* ---- for the machine ---- */

/* k while a move of this axis is traced, else 0. A move that had begun when the trace was armed is not. */
uint16_t trace_every(uint8_t axis);

/* An axis sets out from rest. */
void trace_begin_move(uint8_t axis);

/* The timer's value at a step, counted from 1, the first of the move. Call for every k-th, in order. */
void trace_value(uint8_t axis, uint32_t step, uint16_t value);

/* An axis has come to rest. */
void trace_end_move(uint8_t axis);

#ifdef __cplusplus
}
#endif

#endif
