/* How the step interrupts of a sketch move its pins, which may be any: pins.h's part in a sketch. An axis' step pin is its bit, or
 * `step_mask`, written to PINx, whose address lies in stepramp_step_ports; likewise its direction. */
#ifndef STEPRAMP_ANY_PINS_H
#define STEPRAMP_ANY_PINS_H

#ifndef __ASSEMBLER__

#include <stdbool.h>

/* The pins are coils, and compare B serves all axes. */
extern bool stepramp_has_coils;
#define GAUGE_OUTPUTS stepramp_has_coils

#endif

/* Pins of a line are bits of their axes. */
#define FIRST_STEP_BIT 0
#define LINE_AXIS_3_BIT 3

#ifdef __ASSEMBLER__

#ifdef STEPRAMP_SHARED_QUEUES
#define stepramp_line_queue stepramp_queues
#endif

/* 13 cycles. r24 to r27, r30 and r31 are free then. Timer0 is Arduino's, so that there are no more registers to save in. */
.macro ENTER
	out  GPIOR1, r24
	in   r24, SREG
	out  GPIOR2, r24
	push r25
	push r26
	push r27
	push r30
	push r31
.endm

/* 13 cycles and 4 */
.macro LEAVE
	pop  r31
	pop  r30
	pop  r27
	pop  r26
	pop  r25
	in   r24, GPIOR2
	out  SREG, r24
	in   r24, GPIOR1
	reti
.endm

.macro FREE_Z
.endm

.macro RESTORE_Z
.endm

/* Z = the place in a queue at the offset in r30, which is from its begin. */
.macro POINT_INTO queue
	ldi  r31, 0
	subi r30, lo8(-(\queue))
	sbci r31, hi8(-(\queue))
.endm

/* ---- of axes on their own ---- */

/* The step pin is toggled. 8 cycles. Uses r24; Z is PINx then. */
.macro BEGIN_EDGE axis, pins
	lds  r30, stepramp_step_ports + 2 * \axis
	lds  r31, stepramp_step_ports + 2 * \axis + 1
	lds  r24, PLAYER(\axis, STEP_MASK)
	st   Z, r24
.endm

/* And toggled back, when r24 has its bit. The flags stay. */
.macro END_EDGE pins
	st   Z, r24
.endm

/* The direction turns, when r24 has its pin's bit. */
.macro TURN_EDGE axis, pins
	lds  r30, stepramp_turn_ports + 2 * \axis
	lds  r31, stepramp_turn_ports + 2 * \axis + 1
	st   Z, r24
.endm

/* r30 = the offset after the segment's that was loaded */
.macro NEXT_TAIL axis
	lds  r30, PLAYER(\axis, TAIL)
	subi r30, -QUEUED_SEGMENT_BYTES
	andi r30, QUEUE_BYTES - 1
.endm

/* ---- of a line ---- */

/* Moves an axis' pin when \axes has its bit. 10 cycles, or 3. Uses \scratch and Z; the flags stay. */
.macro TOGGLE_AXIS axis, axes, scratch, ports, masks
	sbrs \axes, \axis
	rjmp stays_\@
	lds  r30, \ports + 2 * \axis
	lds  r31, \ports + 2 * \axis + 1
	lds  \scratch, \masks + \axis
	st   Z, \scratch
stays_\@:
.endm

/* One axis after the other: 0.6 us from one to the next. */
.macro TOGGLE_AXES axes, scratch, ports, masks
	TOGGLE_AXIS 0, \axes, \scratch, \ports, \masks
	TOGGLE_AXIS 1, \axes, \scratch, \ports, \masks
	TOGGLE_AXIS 2, \axes, \scratch, \ports, \masks
	TOGGLE_AXIS 3, \axes, \scratch, \ports, \masks
.endm

.macro TOGGLE pins, scratch
	TOGGLE_AXES \pins, \scratch, stepramp_step_ports, stepramp_step_pins
.endm

/* X is behind the last follower's pin: are there fewer than \count, or as many? Uses r26. */
.macro COMPARE_FOLLOWERS count
.if \count == 1
	subi r26, lo8(stepramp_line_player + LINE_FOLLOWER_PINS)
.endif
	cpi  r26, \count
.endm

/* r25 = the pins of the axes in its bits 0 to 3. */
.macro AXES_TO_PINS
	andi r25, 0x0F
.endm

/* The directions of the axes in r24 turn. Uses r25 and Z. */
.macro TURN_AXES
	TOGGLE_AXES r24, r25, stepramp_turn_ports, stepramp_turn_pins
.endm

/* r30 = the offset after the segment's that was loaded */
.macro NEXT_LINE_TAIL
	lds  r30, stepramp_line_player + LINE_TAIL
	subi r30, -LINE_SEGMENT_BYTES
.endm

#endif

#endif
