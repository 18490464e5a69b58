/* The step interrupts of a sketch that has chosen a timer: the controller's, with that timer's registers and any pins. In
 * a sketch that hasn't, nothing refers to them, and the linker leaves them out. */
#define __SFR_OFFSET 0
#include "boards/timer/timer_registers.h"

#ifdef STEPRAMP_HAS_TIMERS

#define engine_start_at stepramp_timer_start_at
#define lengthen_pulse stepramp_lengthen_pulse
#define line_interrupt stepramp_line_interrupt

/* These are defined in the sketch. */
	.weak stepramp_timer, stepramp_timer_flags, stepramp_timer_mask, __vector_gauges

#include "boards/avr/engine.S"
#include "boards/avr/line.S"

/* For any_pins.h */
	.section .bss
	.global stepramp_step_ports, stepramp_turn_ports, stepramp_step_pins, stepramp_turn_pins
stepramp_step_ports:
	.zero 2 * MOST_AXES
stepramp_turn_ports:
	.zero 2 * MOST_AXES
stepramp_step_pins:
	.zero MOST_AXES
stepramp_turn_pins:
	.zero MOST_AXES

#endif
