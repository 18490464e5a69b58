/* Where everything is connected, and how the step interrupts move it. The step and direction pins are those of the common CNC
 * shield; a sketch chooses its own. */
#ifndef STEPRAMP_PINS_H
#define STEPRAMP_PINS_H

#ifdef STEPRAMP_IN_A_SKETCH

#include "boards/timer/any_pins.h"

#else

/* Port D: axis 0, 1, 2 step on PD2, PD3, PD4 (D2..D4), direction on PD5, PD6, PD7 (D5..D7). */
#define FIRST_STEP_BIT 2
#define FIRST_DIRECTION_BIT 5
#define STEP_PINS_D 0x1C
#define DIRECTION_PINS_D 0xE0

/* Port B: axis 3 steps on PB4 (D12), its direction is PB5 (D13); all drivers are enabled by PB0 (D8). */
#define AXIS_3_STEP_BIT 4
#define AXIS_3_DIRECTION_BIT 5
#define ENABLE_BIT 0

/* Gauges: their coils are D2..D13 in order, so that they take up these bits of the ports. */
#define GAUGE_PINS_D 0xFC
#define GAUGE_PINS_B 0x3F

/* Inputs: PC0 to PC5 (A0 to A5), and PB1 to PB3 (D9 to D11) where no gauges are. */
#define FIRST_INPUT_BIT_B 1
#define INPUT_PINS_B 0x0E

/* Only gauges have D9: as long as it is an output, the pins are coils, and compare B serves all axes. */
#define GAUGE_OUTPUTS ((DDRB & 1 << 1) != 0)

/* In `pins` and such of a line, axis 0, 1, 2 have their bits of port D. Axis 3, which is on port B, has bit 1: on port D
 * that is the serial transmitter's pin, which takes no notice of the port. */
#define LINE_AXIS_3_BIT 1

/* Registers that an interrupt uses are saved where that takes one cycle. Timer0 stands still, so its registers are
 * just bytes. Step interrupts don't nest, and nothing else uses these. */
#define SAVED_R24 GPIOR1
#define SAVED_SREG GPIOR2
#define SAVED_R25 OCR0A
#define SAVED_R26 OCR0B
#define SAVED_R27 TCNT0

#ifdef __ASSEMBLER__

/* 6 cycles. r24 to r27 are free then. */
.macro ENTER
	out  SAVED_R24, r24
	in   r24, SREG
	out  SAVED_SREG, r24
	out  SAVED_R25, r25
	out  SAVED_R26, r26
	out  SAVED_R27, r27
.endm

/* 6 cycles and 4 */
.macro LEAVE
	in   r27, SAVED_R27
	in   r26, SAVED_R26
	in   r25, SAVED_R25
	in   r24, SAVED_SREG
	out  SREG, r24
	in   r24, SAVED_R24
	reti
.endm

/* Z is saved only where a segment is loaded. */
.macro FREE_Z
	push r30
	push r31
.endm

.macro RESTORE_Z
	pop  r31
	pop  r30
.endm

/* Z = the place in a queue whose offset, the low byte of its address, is in r30. */
.macro POINT_INTO queue
	ldi  r31, hi8(\queue)
.endm

/* ---- of axes on their own ---- */

/* The step pin is toggled. 3 cycles. Uses r24. */
.macro BEGIN_EDGE axis, pins
	lds  r24, PLAYER(\axis, STEP_MASK)
	out  \pins, r24
.endm

/* And toggled back, when r24 has its bit. The flags stay. */
.macro END_EDGE pins
	out  \pins, r24
.endm

/* The direction turns, when r24 has its pin's bit. */
.macro TURN_EDGE axis, pins
	out  \pins, r24
.endm

/* r30 = the offset after the segment's whose end Z has come to: around, within a half of 256 bytes */
.macro NEXT_TAIL axis
.if \axis & 1
	ori  r30, QUEUE_BYTES
.else
	andi r30, QUEUE_BYTES - 1
.endif
.endm

/* ---- of a line ---- */

/* Toggles the pins in \pins, port B one instruction later. 5 cycles. Uses \scratch; the flags stay. */
.macro TOGGLE pins, scratch
	ldi  \scratch, 1 << AXIS_3_STEP_BIT
	out  PIND, \pins
	sbrc \pins, LINE_AXIS_3_BIT
	out  PINB, \scratch
.endm

/* X is behind the last follower's pin: are there fewer than \count, or as many? It is in the first 256 bytes behind the queues. */
.macro COMPARE_FOLLOWERS count
	cpi  r26, lo8(stepramp_line_player + LINE_FOLLOWER_PINS + \count)
.endm

/* r25 = the pins of the axes in its bits 0 to 3. */
.macro AXES_TO_PINS
	andi r25, 0x0F
	lsl  r25
	lsl  r25
	bst  r25, FIRST_STEP_BIT + 3
	bld  r25, LINE_AXIS_3_BIT
	andi r25, STEP_PINS_D | 1 << LINE_AXIS_3_BIT
.endm

/* The directions of the axes in r24 turn. Uses r24, r25. */
.macro TURN_AXES
	swap r24
	andi r24, 0xF0
	lsl  r24                             /* axes 0 to 2 are at their pins now, and axis 3 is in the carry */
	ldi  r25, 1 << AXIS_3_DIRECTION_BIT
	out  PIND, r24
	brcc 1f
	out  PINB, r25
1:
.endm

/* r30 = the offset after the segment's whose end Z has come to. */
.macro NEXT_LINE_TAIL
.endm

#endif

#endif

#endif
