/* The step interrupt of a straight line: see step_rings.h. One or more axes lead, up to three follow by Bresenham's
 * algorithm: `due` is negative as long as a follower's next step is yet to come, in units of 1/delta of a leader's step.
 *
 * The pins of an event are known since the event before, so that all of them rise together and without delay. From
 * acceptance to the end of reti: 86 cycles at most without a follower, 104 with one, 125 with two, 146 with three at a steady speed; 9
 * more while it changes, and about 200 more when a piece of a line begins. */
#ifdef STEPRAMP_IN_ASSEMBLY

#define __SFR_OFFSET 0
#include <avr/io.h>

#include "boards/avr/step_interrupt.h"
#include "stepramp/edge/build_options.h"
#include "stepramp/edge/step_rings.h"

#include "boards/avr/pins.h"

	.section .bss
	.global stepramp_line_pulse_pins
#ifndef STEPRAMP_IN_A_SKETCH
	.global stepramp_line_player
stepramp_line_player:
	.zero LINE_PLAYER_BYTES
#endif
stepramp_line_pulse_pins:                             /* pins whose pulses end: not those of which each edge is a step */
	.zero 1

/* Of those pins whose pulses end. 12 cycles. Uses r24, r25. */
.macro END_LINE_PULSE
	lds  r24, stepramp_line_player + LINE_PINS
	lds  r25, stepramp_line_pulse_pins
	and  r24, r25
	sbic GPIOR0, WIDE
	rcall lengthen_pulse
	TOGGLE r24, r25
.endm

/* Follower k: it steps when `due` is not negative, and its pin joins r27. Then as much is added to `due` as step_add, or
 * wait_add, says. 19 cycles either way. Uses r24 to r26. */
.macro FOLLOW k
	lds  r24, stepramp_line_player + LINE_FOLLOWERS + LINE_FOLLOWER_BYTES * \k + DUE_TO_STEP
	lds  r25, stepramp_line_player + LINE_FOLLOWERS + LINE_FOLLOWER_BYTES * \k + DUE_TO_STEP + 1
	sbrc r25, 7
	rjmp follower_\k\()_waits
	lds  r26, stepramp_line_player + LINE_FOLLOWERS + LINE_FOLLOWER_BYTES * \k + STEP_ADD
	add  r24, r26
	lds  r26, stepramp_line_player + LINE_FOLLOWERS + LINE_FOLLOWER_BYTES * \k + STEP_ADD + 1
	adc  r25, r26
	lds  r26, stepramp_line_player + LINE_FOLLOWER_PINS + \k
	or   r27, r26
follower_\k\()_follows:
	sts  stepramp_line_player + LINE_FOLLOWERS + LINE_FOLLOWER_BYTES * \k + DUE_TO_STEP, r24
	sts  stepramp_line_player + LINE_FOLLOWERS + LINE_FOLLOWER_BYTES * \k + DUE_TO_STEP + 1, r25
.endm

/* What FOLLOW leaves out. */
.macro WAIT k
follower_\k\()_waits:
	lds  r26, stepramp_line_player + LINE_FOLLOWERS + LINE_FOLLOWER_BYTES * \k + WAIT_ADD
	add  r24, r26
	lds  r26, stepramp_line_player + LINE_FOLLOWERS + LINE_FOLLOWER_BYTES * \k + WAIT_ADD + 1
	adc  r25, r26
	rjmp follower_\k\()_follows
.endm

	.section .text.step_interrupt, "ax", @progbits

#ifndef STEPRAMP_IN_A_SKETCH
/* Steps on the way of branches that don't reach far enough. They stand here so that what is frequent costs no jump. */
to_count_high:
	rjmp line_count_high
#endif

	.global line_interrupt
line_interrupt:
	ENTER
line_event:
	lds  r26, stepramp_line_player + LINE_PINS
	TOGGLE r26, r27
	lds  r24, stepramp_line_player + LINE_INTERVAL
	lds  r25, stepramp_line_player + LINE_INTERVAL + 1
	sbic GPIOR0, LINE_STEADY
	rjmp 1f
	lds  r26, stepramp_line_player + LINE_ADD
	lds  r27, stepramp_line_player + LINE_ADD + 1
	add  r26, r24
	adc  r27, r25
	sts  stepramp_line_player + LINE_INTERVAL, r26
	sts  stepramp_line_player + LINE_INTERVAL + 1, r27
1:	lds  r26, OCR1AL
	lds  r27, OCR1AH
	add  r26, r24
	adc  r27, r25
	PROGRAM OCR1AL
	lds  r24, stepramp_line_player + LINE_COUNT
	subi r24, 1
	sts  stepramp_line_player + LINE_COUNT, r24
#ifdef STEPRAMP_IN_A_SKETCH
	brcc line_counted
	rjmp line_count_high
#else
	brcs to_count_high
#endif
line_counted:
	lds  r27, stepramp_line_player + LINE_LEADER_PINS
	sbis GPIOR0, LINE_FOLLOWED           /* silent, then the followers wait too, or there are none */
	rjmp next_is_known
	FOLLOW 0
	sbis GPIOR0, LINE_TWO
	rjmp next_is_known
	FOLLOW 1
	sbis GPIOR0, LINE_THREE
	rjmp next_is_known
	FOLLOW 2
next_is_known:
	END_LINE_PULSE
	sts  stepramp_line_player + LINE_PINS, r27
	lds  r26, OCR1AL
	lds  r27, OCR1AH
	COMPARE_WITH_TIMER
	brmi line_again
line_leave:
	LEAVE
line_again:
	GO_IF_STOPPED line_leave
#if COUNTS_LATENESS
	GO_IF_LATE line_late
line_again_soon:
#endif
	ldi  r24, 1 << OCF1A                 /* its compare match may have come as well: it isn't to be served twice */
	out  TIFR1, r24
	rjmp line_event
#if COUNTS_LATENESS
line_late:                                   /* as of an axis alone */
	CONFIRM_LATE line_again_soon
	COUNT_LATE OCF1A
	FROM_NOW stepramp_line_player + LINE_INTERVAL
	PROGRAM OCR1AL
	lpm  r24, Z                          /* 8 cycles, as COMPARE_WITH_TIMER wants */
	lpm  r24, Z
	COMPARE_WITH_TIMER
	brmi line_again
	LEAVE
#endif

	WAIT 0
	WAIT 1
	WAIT 2

line_count_high:
	lds  r24, stepramp_line_player + LINE_COUNT + 1
	subi r24, 1
	sts  stepramp_line_player + LINE_COUNT + 1, r24
	brcs line_load
	rjmp line_counted

to_park_line:
	rjmp park_line
line_load:
	lds  r26, TCNT1L                     /* always so long after the edge: what is traced */
	lds  r27, TCNT1H
	FREE_Z
	lds  r30, stepramp_line_player + LINE_TAIL
	lds  r24, stepramp_line_player + LINE_HEAD
	cp   r30, r24
	breq to_park_line
	POINT_INTO stepramp_line_queue
	COPY_INTERVAL stepramp_line_player + LINE_INTERVAL
	ldi  r26, lo8(stepramp_line_player + LINE_ADD)
	ldi  r27, hi8(stepramp_line_player + LINE_ADD)
	ld   r25, Z+
	st   X+, r25
	ld   r24, Z+
	st   X+, r24
	cbi  GPIOR0, LINE_STEADY
	or   r24, r25
	brne 1f
	sbi  GPIOR0, LINE_STEADY
1:	ld   r24, Z+
	st   X+, r24
	ld   r24, Z+
	st   X+, r24
	ld   r24, Z+
	ld   r25, Z+
	sbiw r24, 0
	brne begin_piece
	adiw r30, 2 * MOST_FOLLOWERS         /* total is 0: the piece goes on, or is silent */
	ld   r25, Z+
	cbi  GPIOR0, LINE_FOLLOWED
	cpi  r25, LINE_FIRST_FOLLOWER
	brcs 1f
	sbi  GPIOR0, LINE_FOLLOWED
1:	rjmp set_leaders

/* r25:r24 = total; the deltas come next in the queue, and go, with what follows from them, to the
 * followers, at X. At first a follower is due by delta - total + total / 2: so its steps lie in the middle of their time. */
begin_piece:
	push r20
	push r21
	push r22
	push r23
	movw r22, r24
	lsr  r23
	ror  r22
1:	ld   r20, Z+
	ld   r21, Z+
	st   X+, r20
	st   X+, r21
	sub  r20, r24
	sbc  r21, r25
	st   X+, r20
	st   X+, r21
	add  r20, r22
	adc  r21, r23
	st   X+, r20
	st   X+, r21
	cpi  r26, lo8(stepramp_line_player + LINE_FOLLOWER_PINS)
	brne 1b
	pop  r23
	pop  r22
	pop  r21
	pop  r20
	ld   r25, Z+
	/* bits 4 to 7 of r25: the followers. Their pins in the order of the axes, at X. */
	ldi  r24, 1 << FIRST_STEP_BIT
	sbrc r25, 4
	st   X+, r24
	lsl  r24
	sbrc r25, 5
	st   X+, r24
	lsl  r24
	sbrc r25, 6
	st   X+, r24
	ldi  r24, 1 << LINE_AXIS_3_BIT
	sbrc r25, 7
	st   X+, r24
	in   r24, GPIOR0
	andi r24, ~(1 << LINE_TWO | 1 << LINE_THREE | 1 << LINE_FOLLOWED)
	COMPARE_FOLLOWERS 1
	brcs 2f
	ori  r24, 1 << LINE_FOLLOWED
	COMPARE_FOLLOWERS 2
	brcs 2f
	breq 1f
	ori  r24, 1 << LINE_THREE
1:	ori  r24, 1 << LINE_TWO
2:	out  GPIOR0, r24

/* r25: the leaders in bits 0 to 3, the followers above, both 0 when silent. The axes that turn come next in the queue. */
set_leaders:
	AXES_TO_PINS
	sts  stepramp_line_player + LINE_LEADER_PINS, r25
	ld   r24, Z+
	TURN_AXES
	NEXT_LINE_TAIL
	sts  stepramp_line_player + LINE_TAIL, r30    /* the queue has 256 bytes: the offset wraps by itself */
	RESTORE_Z
	rjmp line_counted

park_line:
	END_LINE_PULSE
	ldi  r30, lo8(stepramp_line_player)
	ldi  r31, hi8(stepramp_line_player)
	ldd  r24, Z + LINE_EMPTY
	inc  r24
	std  Z + LINE_EMPTY, r24
	ldi  r24, lo8(LONGEST_WAIT_TICKS)
	std  Z + LINE_INTERVAL, r24
	ldi  r24, hi8(LONGEST_WAIT_TICKS)
	std  Z + LINE_INTERVAL + 1, r24
	ldi  r24, 0
	std  Z + LINE_ADD, r24
	std  Z + LINE_ADD + 1, r24
	std  Z + LINE_COUNT, r24
	std  Z + LINE_COUNT + 1, r24
	std  Z + LINE_LEADER_PINS, r24
	std  Z + LINE_PINS, r24
	sts  TIMSK1, r24                     /* on a line nothing else uses this timer's interrupts */
	RESTORE_Z
	LEAVE

#endif
