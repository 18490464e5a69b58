/* What the step interrupts have in common, in assembly (engine.S, line.S) and in C. They are the controller's and, with
 * another timer and any pins, those of a sketch (boards/timer/): how pins are moved and registers saved is in pins.h.
 *
 * Timer1 counts freely. Compare A serves axes 0 and 2, compare B axes 1 and 3: two channels with up to two axes each.
 * Invariants outside of an interrupt:
 *  - a channel's interrupt is enabled as long as one of its axes runs;
 *  - OCR1A, OCR1B hold the time of their channel's next event;
 *  - with two axes running, SHARED is set, SECOND tells whose event that is, and both `due` are right; with one, SHARED
 *    is clear, SECOND tells which of them runs, and its `due` is stale. */
#ifndef STEPRAMP_STEP_INTERRUPT_H
#define STEPRAMP_STEP_INTERRUPT_H

#include "stepramp/edge/build_options.h"

/* Bits of GPIOR0: a test is one instruction, and so is setting one. engine.c counts on the places of the next four. */
#define OTHER_MODE 0     /* compare A plays the line, or compare B the gauges: GAUGE_OUTPUTS of pins.h tells */
#define A_SECOND 1       /* channel A's next event is axis 2's */
#define B_SECOND 2       /* channel B's next event is axis 3's */
#define A_SHARED 3       /* both axes 0 and 2 run */
#define B_SHARED 4       /* both axes 1 and 3 run */
#define WIDE 5           /* pulses are to be lengthened */
#define LISTENS 7        /* the serial port's interrupts may come while a pulse is lengthened */
#define LINE_FOLLOWED 6  /* on a line: an axis follows, in the present segment */
#define LINE_TWO A_SECOND   /* on a line: there is a second follower */
#define LINE_THREE A_SHARED /* and a third */
#define LINE_STEADY B_SECOND /* its interval stays as it is: at full speed there is no time to add 0 */

/* Offsets in struct axis_player */
#define DUE 0
#define INTERVAL 2
#define ADD 4
#define COUNT 6
#define STEP_MASK 8
#define TAIL 9
#define HEAD 10
#define EMPTY 11

#define PLAYER(axis, field) (stepramp_axis_players + (axis) * AXIS_PLAYER_BYTES + (field))

/* Offsets in struct line_player */
#define LINE_INTERVAL 0
#define LINE_ADD 2
#define LINE_COUNT 4
#define LINE_FOLLOWERS 6
#define LINE_FOLLOWER_PINS 24
#define LINE_PINS 27
#define LINE_LEADER_PINS 28
#define LINE_TAIL 29
#define LINE_HEAD 30
#define LINE_EMPTY 31
#define LINE_PLAYER_BYTES 33

#define LINE_FIRST_FOLLOWER 0x10 /* LINE_AXES(0, 1) */

/* Offsets in struct line_follower */
#define WAIT_ADD 0
#define STEP_ADD 2
#define DUE_TO_STEP 4
#define LINE_FOLLOWER_BYTES 6

#ifdef __ASSEMBLER__

/* While a wide pulse was waited for the emergency stop may have come: then to \stopped. 4 cycles. Uses r24. */
.macro GO_IF_STOPPED stopped
#if HAS_INPUTS
	lds  r24, stepramp_emergency
	tst  r24
	brne \stopped
#endif
.endm

/* Where the program has inputs it can tell that steps came late: see lateness.h. */
#define LEAST_LATE 3 /* [256 ticks] machine_inputs.c never makes up for less */

/* The event at r27:r26 is past: may it be so by more than is made up for? Then to \late. r25 is the timer's high byte, or 0
 * where the only axis of a channel waited for a wide pulse: a yes of that is looked at again there, a no, where r27 is 0, 254
 * or 255, isn't, and one late step is made up for, unless those behind it are late, too. 3 cycles, as many as there are to
 * spare here. */
.macro GO_IF_LATE late
	sub  r25, r27
	cpi  r25, LEAST_LATE
	brsh \late
.endm

/* r25 = by how much [256 ticks]; back to \soon when it isn't late after all. Uses r24. */
.macro CONFIRM_LATE soon
	lds  r24, TCNT1L
	lds  r25, TCNT1H
	sub  r24, r26
	sbc  r25, r27
	lds  r24, stepramp_late_from
	cp   r25, r24
	brlo \soon
.endm

/* Adds r25 to what is counted, and forgets a compare match that has come meanwhile. Uses r24, r25. */
.macro COUNT_LATE flag
	lds  r24, stepramp_late
	add  r24, r25
	brcc 1f
	ldi  r24, 0xFF
1:	sts  stepramp_late, r24
	ldi  r24, 1 << \flag
	out  TIFR1, r24
.endm

/* r27:r26 = so long from now. 10 cycles. Uses r24, r25. */
.macro FROM_NOW interval
	lds  r26, TCNT1L
	lds  r27, TCNT1H
	lds  r24, \interval
	lds  r25, \interval + 1
	add  r26, r24
	adc  r27, r25
.endm

/* r27:r26 = time of the event after this one; interval += add. 22 cycles. Uses r24, r25. */
.macro ADVANCE interval, add, ocr
	lds  r24, \interval
	lds  r25, \interval + 1
	lds  r26, \add
	lds  r27, \add + 1
	add  r26, r24
	adc  r27, r25
	sts  \interval, r26
	sts  \interval + 1, r27
	lds  r26, \ocr
	lds  r27, \ocr + 1
	add  r26, r24
	adc  r27, r25
.endm

/* The next event is at r27:r26. 4 cycles. The high byte first: it is kept until the low one comes. */
.macro PROGRAM ocr
	sts  \ocr + 1, r27
	sts  \ocr, r26
.endm

/* Negative when the event at r27:r26 is past. 6 cycles. Uses r24, r25.
 * Then its compare match may have been missed. If it isn't past, the compare register must have been written at least
 * 8 cycles ago, the longest tick: then there is a whole tick in which it matches. */
.macro COMPARE_WITH_TIMER
	lds  r24, TCNT1L
	lds  r25, TCNT1H
	cp   r26, r24
	cpc  r27, r25
.endm

/* Copies a byte from the queue. 4 cycles. Uses r24. */
.macro COPY to
	ld   r24, Z+
	sts  \to, r24
.endm

/* Copies the interval, whose place then gets the timer's value in r27:r26. 12 cycles. Uses r24. */
.macro COPY_INTERVAL to
	ld   r24, Z
	st   Z+, r26
	sts  \to, r24
	ld   r24, Z
	st   Z+, r27
	sts  \to + 1, r24
.endm

#endif

#endif
