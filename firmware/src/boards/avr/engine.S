/* The step interrupts of axes that move on their own: see step_interrupt.h and step_rings.h.
 *
 * From the compare match to the edge of the step pin it is 22 to 25 cycles, and what the processor needs to finish its
 * instruction. From acceptance to the end of reti: 74 cycles for the only axis of a channel, 91 to 94 for one of two, and
 * about 85 more when a segment ends.
 *
 * All pins are moved by writing ones to PINx, which toggles them. So pins that rest high need nothing special. */
#ifdef STEPRAMP_IN_ASSEMBLY

#define __SFR_OFFSET 0
#include <avr/io.h>

#include "boards/avr/step_interrupt.h"
#include "stepramp/edge/build_options.h"
#include "stepramp/edge/step_rings.h"

#include "boards/avr/pins.h"

#define QUEUE(axis) (stepramp_queues + (axis) * QUEUE_BYTES)

/* ---- memory ---- */

	.section .bss
	.global stepramp_end_masks, stepramp_pulse_masks, stepramp_extra_width
#ifndef STEPRAMP_IN_A_SKETCH
	.global stepramp_axis_players
stepramp_axis_players:
	.zero MOST_AXES * AXIS_PLAYER_BYTES
#endif
stepramp_end_masks:                            /* what ends the pulse of an axis: step_mask, or 0 when each edge is a step */
	.zero MOST_AXES
stepramp_pulse_masks:                          /* what of an axis' step_mask ends its pulses: all ones, or 0 */
	.zero MOST_AXES
stepramp_extra_width:                          /* of pulses, when WIDE is set [8 cycles], not 0 */
	.zero 1

/* The offsets in queues are low bytes of addresses, so these are aligned to 256 bytes. The linker puts them to the begin
 * of the RAM, where that leaves no gap: see the Makefile. */
	.global stepramp_queues, stepramp_line_queue

/* ---- parts of an event ---- */

/* The edge, and then r27:r26 = time of the next event. 25 cycles, the edge at the third. Uses r24, r25. */
.macro BEGIN_EVENT axis, pins, ocr
	BEGIN_EDGE \axis, \pins
	ADVANCE PLAYER(\axis, INTERVAL), PLAYER(\axis, ADD), \ocr
.endm

/* 6 cycles. Uses r24. */
.macro COUNT_EVENT axis, borrow
	lds  r24, PLAYER(\axis, COUNT)
	subi r24, 1
	sts  PLAYER(\axis, COUNT), r24
	brcs \borrow
.endm

/* 5 cycles; the flags stay. Uses r24, and r25 when the pulse is to be longer. */
.macro END_PULSE axis, pins
	lds  r24, stepramp_end_masks + \axis
	sbic GPIOR0, WIDE
	rcall lengthen_pulse
	END_EDGE \pins
.endm

/* The compare match of an event that is past may have come as well: it isn't to be served twice. 2 cycles. Uses r24. */
.macro FORGET_MATCH flag
	ldi  r24, 1 << \flag
	out  TIFR1, r24
.endm

/* Every 256th event: the high byte of the count. Goes back to `counted` unless that runs over too. Uses r24. */
.macro COUNT_HIGH axis, counted
	lds  r24, PLAYER(\axis, COUNT + 1)
	subi r24, 1
	sts  PLAYER(\axis, COUNT + 1), r24
	brcc \counted
.endm

/* ---- loading a segment ---- */

/* A function: ends the pulse and loads the axis' next segment. Sets the T flag when there is none: then the axis is
 * parked. 76 cycles with its call. Uses r24 to r27. */
.macro LOAD_FUNCTION axis, pins
load_\axis:
	lds  r26, TCNT1L                     /* always so long after the edge: what is traced */
	lds  r27, TCNT1H
	FREE_Z
	END_PULSE \axis, \pins
	lds  r30, PLAYER(\axis, TAIL)
	lds  r24, PLAYER(\axis, HEAD)
	cp   r30, r24
	breq park_\axis
	POINT_INTO QUEUE(\axis)
	COPY_INTERVAL PLAYER(\axis, INTERVAL)
	COPY PLAYER(\axis, ADD)
	COPY PLAYER(\axis, ADD + 1)
	COPY PLAYER(\axis, COUNT)
	COPY PLAYER(\axis, COUNT + 1)
	COPY PLAYER(\axis, STEP_MASK)
	lds  r25, stepramp_pulse_masks + \axis
	and  r24, r25
	sts  stepramp_end_masks + \axis, r24
	ld   r24, Z+
	TURN_EDGE \axis, \pins
	NEXT_TAIL \axis
	sts  PLAYER(\axis, TAIL), r30
	clt
	RESTORE_Z
	ret
park_\axis:
	ldi  r24, 0
	sts  stepramp_end_masks + \axis, r24
	ldi  r30, lo8(PLAYER(\axis, INTERVAL))
	ldi  r31, hi8(PLAYER(\axis, INTERVAL))
	rjmp park
.endm

/* ---- the only axis of a channel ---- */

/* 53 cycles to the end of reti. */
.macro ONLY_AXIS axis, pins, channel, ocr
only_\axis:
	BEGIN_EVENT \axis, \pins, \ocr
	PROGRAM \ocr
	COUNT_EVENT \axis, 8f
7:	COMPARE_WITH_TIMER                   /* before the pulse ends: it needs the time anyway */
	END_PULSE \axis, \pins
	brmi 6f
	LEAVE
6:	rjmp again_\channel
8:	COUNT_HIGH \axis, 7b
	rcall load_\axis
	rjmp loaded_alone_\channel
.endm

/* ---- one of the two axes of a channel ---- */

/* `other_is_next` makes SECOND tell so. 68 or 69 cycles to the end of reti. */
.macro SHARING_AXIS axis, other, pins, channel, ocr, other_is_next, shared, second
sharing_\axis:
	BEGIN_EVENT \axis, \pins, \ocr
	sts  PLAYER(\axis, DUE), r26
	sts  PLAYER(\axis, DUE + 1), r27
	COUNT_EVENT \axis, 8f
7:	lds  r24, PLAYER(\other, DUE)
	lds  r25, PLAYER(\other, DUE + 1)
	cp   r26, r24
	cpc  r27, r25
	brmi 5f                              /* this axis is the next one again */
	\other_is_next GPIOR0, \second
	movw r26, r24
5:	PROGRAM \ocr
	END_PULSE \axis, \pins
	nop                                  /* the eighth cycle since the compare register was written */
	COMPARE_WITH_TIMER
	brmi 6f
	LEAVE
6:	rjmp again_shared_\channel
8:	COUNT_HIGH \axis, 7b
	rcall load_\axis
	brtc 9f
	cbi  GPIOR0, \shared                 /* parked: the other one is alone */
	\other_is_next GPIOR0, \second
	lds  r26, PLAYER(\other, DUE)
	lds  r27, PLAYER(\other, DUE + 1)
	rjmp program_\channel
9:	rjmp find_next_\channel
.endm

/* What is rare. loaded_alone: a segment of the only axis was loaded, or not. find_next: which of two axes has the next event? program: it is at r27:r26. again: it is past. */
.macro CHANNEL_PARTS channel, first_axis, second_axis, ocr, flag, enable_bit, shared, second
loaded_alone_\channel:
	brts 1f
	lds  r26, \ocr
	lds  r27, \ocr + 1
	COMPARE_WITH_TIMER
	brmi again_\channel
	LEAVE
1:	lds  r24, TIMSK1                     /* parked: no axis runs */
	andi r24, ~(1 << \enable_bit) & 0xFF
	sts  TIMSK1, r24
	LEAVE
find_next_\channel:
	lds  r26, PLAYER(\first_axis, DUE)
	lds  r27, PLAYER(\first_axis, DUE + 1)
	lds  r24, PLAYER(\second_axis, DUE)
	lds  r25, PLAYER(\second_axis, DUE + 1)
	cbi  GPIOR0, \second
	cp   r24, r26
	cpc  r25, r27
	brpl program_\channel
	sbi  GPIOR0, \second
	movw r26, r24
program_\channel:
	PROGRAM \ocr
	lpm  r24, Z                          /* 8 cycles, as COMPARE_WITH_TIMER wants */
	lpm  r24, Z
	COMPARE_WITH_TIMER
	brmi again_\channel
leave_\channel:
	LEAVE
again_\channel:
	GO_IF_STOPPED leave_\channel
#if COUNTS_LATENESS
	GO_IF_LATE late_\channel
again_soon_\channel:
#endif
	FORGET_MATCH \flag
	rjmp dispatch_\channel
#if COUNTS_LATENESS
/* What was missed isn't made up for: the next event comes an interval from now, and so do those behind it. Then the other
 * axis: where it is past as well its time can't be compared with this one's, which may be half of the timer's round ahead. */
late_\channel:
	CONFIRM_LATE again_soon_\channel
count_late_\channel:
	COUNT_LATE \flag
	sbic GPIOR0, \second
	rjmp 2f
	FROM_NOW PLAYER(\first_axis, INTERVAL)
	sts  PLAYER(\first_axis, DUE), r26
	sts  PLAYER(\first_axis, DUE + 1), r27
	sbis GPIOR0, \shared
	rjmp program_\channel
	sbi  GPIOR0, \second
	lds  r26, PLAYER(\second_axis, DUE)
	lds  r27, PLAYER(\second_axis, DUE + 1)
	rjmp 3f
2:	FROM_NOW PLAYER(\second_axis, INTERVAL)
	sts  PLAYER(\second_axis, DUE), r26
	sts  PLAYER(\second_axis, DUE + 1), r27
	sbis GPIOR0, \shared
	rjmp program_\channel
	cbi  GPIOR0, \second
	lds  r26, PLAYER(\first_axis, DUE)
	lds  r27, PLAYER(\first_axis, DUE + 1)
3:	COMPARE_WITH_TIMER
	brmi 4f
	rjmp find_next_\channel
4:	CONFIRM_LATE 5f
	rjmp count_late_\channel             /* it is late, too */
5:	lds  r26, TCNT1L                     /* or is due now */
	lds  r27, TCNT1H
	rjmp program_\channel
#endif
.endm

/* ---- the interrupts ---- */

/* From the vector's jump 4 to 7 cycles and ENTER. again_shared: an event of one of two axes is past. That it is shared is known: four
 * axes at their limits leave no cycles to ask again. */
.macro DISPATCH channel, first_axis, second_axis, flag, shared, second
dispatch_\channel:
	sbic GPIOR0, \shared
	rjmp sharing_\channel
	sbic GPIOR0, \second
	rjmp only_\second_axis
	rjmp only_\first_axis
#if COUNTS_LATENESS
late_shared_\channel:
	rjmp late_\channel
#endif
#if HAS_INPUTS
stopped_\channel:
	rjmp leave_\channel
#endif
again_shared_\channel:
	GO_IF_STOPPED stopped_\channel
#if COUNTS_LATENESS
	GO_IF_LATE late_shared_\channel
#endif
	FORGET_MATCH \flag
sharing_\channel:
	sbic GPIOR0, \second
	rjmp sharing_\second_axis
	rjmp sharing_\first_axis
.endm

	.section .text.step_interrupt, "ax", @progbits

	.global TIMER1_COMPA_vect
TIMER1_COMPA_vect:
	sbic GPIOR0, OTHER_MODE
	rjmp line_interrupt
	ENTER
	sbic GPIOR0, A_SHARED
	rjmp sharing_a
	sbic GPIOR0, A_SECOND
	rjmp only_2
	ONLY_AXIS 0, PIND, a, OCR1AL
	ONLY_AXIS 2, PIND, a, OCR1AL
	DISPATCH a, 0, 2, OCF1A, A_SHARED, A_SECOND
	SHARING_AXIS 0, 2, PIND, a, OCR1AL, sbi, A_SHARED, A_SECOND
	SHARING_AXIS 2, 0, PIND, a, OCR1AL, cbi, A_SHARED, A_SECOND
	CHANNEL_PARTS a, 0, 2, OCR1AL, OCF1A, OCIE1A, A_SHARED, A_SECOND

	.global TIMER1_COMPB_vect
TIMER1_COMPB_vect:
	sbic GPIOR0, OTHER_MODE
	rjmp gauges
	ENTER
	sbic GPIOR0, B_SHARED
	rjmp sharing_b
	sbic GPIOR0, B_SECOND
	rjmp only_3
	ONLY_AXIS 1, PIND, b, OCR1BL
	ONLY_AXIS 3, PINB, b, OCR1BL
	DISPATCH b, 1, 3, OCF1B, B_SHARED, B_SECOND
	SHARING_AXIS 1, 3, PIND, b, OCR1BL, sbi, B_SHARED, B_SECOND
	SHARING_AXIS 3, 1, PINB, b, OCR1BL, cbi, B_SHARED, B_SECOND
	CHANNEL_PARTS b, 1, 3, OCR1BL, OCF1B, OCIE1B, B_SHARED, B_SECOND
gauges:
	jmp  __vector_gauges

	LOAD_FUNCTION 0, PIND
	LOAD_FUNCTION 1, PIND
	LOAD_FUNCTION 2, PIND
	LOAD_FUNCTION 3, PINB

/* The end of a load function that found nothing, with Z at the player's interval. Uses r24, r25. */
park:
	ldi  r24, lo8(LONGEST_WAIT_TICKS)
	ldi  r25, hi8(LONGEST_WAIT_TICKS)
	std  Z + INTERVAL - INTERVAL, r24
	std  Z + INTERVAL + 1 - INTERVAL, r25
	ldi  r24, 0
	std  Z + ADD - INTERVAL, r24
	std  Z + ADD + 1 - INTERVAL, r24
	std  Z + COUNT - INTERVAL, r24
	std  Z + COUNT + 1 - INTERVAL, r24
	std  Z + STEP_MASK - INTERVAL, r24
	ldd  r24, Z + EMPTY - INTERVAL
	inc  r24
	std  Z + EMPTY - INTERVAL, r24
	set
	RESTORE_Z
	ret

/* 8 cycles each, as many as r25 says, but for the last: 7. */
.macro WAIT_UNITS
1:	rjmp 2f                              /* two cycles each */
2:	rjmp 3f
3:	nop
	dec  r25
	brne 1b
.endm

/* Waits for stepramp_extra_width times 8 cycles, 19 more with its call, when r24 has a pin whose pulse is to end. When that is
 * long the serial port's interrupts may come meanwhile: wide pulses don't make it deaf. Then it is 33 more. Uses r25; the
 * flags stay. */
	.global lengthen_pulse
lengthen_pulse:
	push r26
	in   r26, SREG
	tst  r24
	breq 4f
	sbic GPIOR0, LISTENS
	rjmp 5f
	lds  r25, stepramp_extra_width
	WAIT_UNITS
4:	out  SREG, r26
	pop  r26
	ret
5:	push r27
	lds  r27, TIMSK1
	ldi  r25, 0
	sts  TIMSK1, r25                     /* step interrupts don't nest */
	lds  r25, stepramp_extra_width
	sei
	WAIT_UNITS
	cli
#if HAS_INPUTS
	lds  r25, stepramp_emergency
	tst  r25
	brne 6f                              /* none come any more */
#endif
	sts  TIMSK1, r27
6:	pop  r27
	rjmp 4b

/* ---- starting ---- */

/* Adds those axes of a channel that have a bit in r20. They don't run, and their `due` is the start, r25:r24. Either the
 * channel has none running; or its other one runs, whose event may be waiting to be served: then it is past, and so before
 * the start. About 30 cycles. Uses r18, r19. */
.macro START_CHANNEL first_axis, second_axis, ocr, flag, enable_bit, shared, second
	mov  r18, r20
	andi r18, 1 << \first_axis | 1 << \second_axis
	breq 9f
	lds  r19, TIMSK1
	sbrc r19, \enable_bit
	rjmp 5f
	ori  r19, 1 << \enable_bit
	cbi  GPIOR0, \shared
	cbi  GPIOR0, \second
	sbrs r18, \first_axis
	sbi  GPIOR0, \second
	cpi  r18, 1 << \first_axis | 1 << \second_axis
	brne 1f
	sbi  GPIOR0, \shared
1:	ldi  r18, 1 << \flag
	sts  \ocr + 1, r25
	sts  \ocr, r24
	out  TIFR1, r18
	sts  TIMSK1, r19
	rjmp 9f
5:	lds  r18, \ocr
	lds  r19, \ocr + 1
	sbic GPIOR0, \second
	rjmp 6f
	sts  PLAYER(\first_axis, DUE), r18
	sts  PLAYER(\first_axis, DUE + 1), r19
	cp   r24, r18
	cpc  r25, r19
	brpl 8f
	sbi  GPIOR0, \second
	rjmp 7f
6:	sts  PLAYER(\second_axis, DUE), r18
	sts  PLAYER(\second_axis, DUE + 1), r19
	cp   r24, r18
	cpc  r25, r19
	brpl 8f
	cbi  GPIOR0, \second
7:	sts  \ocr + 1, r25
	sts  \ocr, r24
8:	sbi  GPIOR0, \shared
9:
.endm

/* bool engine_start_at(uint16_t start, uint16_t latest, uint8_t axes)
 * Starts axes, all in one short blocked section, about 80 cycles. Returns false when it is later than `latest`. */
	.global engine_start_at
engine_start_at:
	in   r21, SREG
	cli
	lds  r18, TCNT1L
	lds  r19, TCNT1H
	cp   r22, r18
	cpc  r23, r19
	brpl 3f
	out  SREG, r21
	ldi  r24, 0
	ret
3:
#if HAS_INPUTS
	lds  r18, stepramp_emergency
	tst  r18
	breq 2f
	rjmp 4f                              /* they stay where they are */
2:
#endif
	START_CHANNEL 0, 2, OCR1AL, OCF1A, OCIE1A, A_SHARED, A_SECOND
	START_CHANNEL 1, 3, OCR1BL, OCF1B, OCIE1B, B_SHARED, B_SECOND
4:	out  SREG, r21
	ldi  r24, 1
	ret

#endif
