/* What the engine of a sketch that has chosen a timer gives: each in the place of the function without `stepramp_timer_` (engine.h,
 * step_queue.h, board.h, arduino_board.h). */
#ifndef STEPRAMP_TIMER_BOARD_H
#define STEPRAMP_TIMER_BOARD_H

#include <stdbool.h>
#include <stdint.h>

#include "stepramp/edge/engine.h"

#ifdef __cplusplus
extern "C" {
#endif

struct settings;

void stepramp_timer_begin(void);
void stepramp_timer_set_clock(bool fast);
void stepramp_timer_start(uint8_t axes, uint16_t setup_ticks);
void stepramp_timer_halt(uint8_t axes);
void stepramp_timer_clear(uint8_t axes);

void stepramp_timer_set_line(bool line);
uint8_t stepramp_timer_running(void);
uint16_t stepramp_timer_now(void);
struct engine_progress stepramp_timer_progress(uint8_t axis);
uint8_t stepramp_timer_step_mask(uint8_t axis);
uint8_t stepramp_timer_turn_mask(uint8_t axis);

void stepramp_timer_configure(const struct settings *settings);
uint16_t stepramp_timer_time(void);

void stepramp_timer_use_gauges(void);
void stepramp_timer_play_gauges(void);

void stepramp_timer_end_events(void);
bool stepramp_timer_watch_pin(uint8_t pin);
void stepramp_timer_look_at_stops(void);

/* The table of what it can do, in flash. */
const void *stepramp_timer_limits(void);

#ifdef __cplusplus
}
#endif

#endif
