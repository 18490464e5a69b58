/* The controller's engine with the timer and the pins of a sketch. Its functions have names of their own: the sketch's header
 * puts them in the place of those of boards/polled/ (timer_choice.h). */
#include "boards/timer/timer_registers.h"

#ifdef STEPRAMP_HAS_TIMERS

#define step_queue_begin stepramp_timer_begin
#define step_queue_set_clock stepramp_timer_set_clock
#define step_queue_start stepramp_timer_start
#define step_queue_halt stepramp_timer_halt
#define step_queue_clear stepramp_timer_clear
#define engine_set_line stepramp_timer_set_line
#define engine_running stepramp_timer_running
#define engine_now stepramp_timer_now
#define engine_progress stepramp_timer_progress
#define engine_start_at stepramp_timer_start_at

#include "boards/avr/gauge.h"
#include "boards/timer/timer_gauges.h"

#define gauges_start(axes, delay_ticks) stepramp_gauges->start(axes, delay_ticks)
#define gauges_halt(axes) stepramp_gauges->halt(axes)
#define gauges_running() stepramp_gauges->running()

#include "boards/avr/engine.c"

#else

typedef int board_has_no_such_timer; /* ISO C wants something in each file */

#endif
