/* The engine with a timer that you read and pins that you move: where there is a clock but no such interrupt. It is not
 * reentrant: don't call it and the functions of step_queue.h from an interrupt and outside of it. */
#ifndef STEPRAMP_POLLED_ENGINE_H
#define STEPRAMP_POLLED_ENGINE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Called at each event with a step, with the bits of the axes that make one: make their pulses. And when directions
 * turn. `engine_now` tells the tick of the event, which may be past. NULL: nothing is called. */
void polled_engine_set_outputs(void (*step)(uint8_t axes), void (*turn)(uint8_t axes));

/* A tick is 1/16 us, or else 1/2 us. */
bool polled_engine_is_fast(void);

/* It is `now`, in ticks of your own choice, for instance micros(): plays all events up to then in their order. Returns the
 * ticks from `now` to the next one; when no axis runs, LONGEST_WAIT_TICKS. To be called at least once in 30,000 ticks. */
uint16_t polled_engine_play(uint16_t now);

#ifdef __cplusplus
}
#endif

#endif
