/* The serial port's interrupts: a byte has been received, a byte can be sent. Each lets step interrupts come as soon as it
 * has masked both of them, 18 cycles after its acceptance, and again blocks them only for its last 10. So they don't nest,
 * and the stack needs room for one of them and a step interrupt. 63 and 67 cycles in all, 70 at the end of a frame.
 *
 * Where step interrupts listen, with wide pulses, they are blocked for all of that: they would keep these from their end for
 * too long. */
#define __SFR_OFFSET 0
#include <avr/io.h>

#include "serial.h"

#define MASKED (1 << RXEN0 | 1 << TXEN0)

	.section .bss
	.global received, received_in, received_out, serial_control, serial_next
received:
	.zero RECEIVED_BYTES
received_in:                                 /* index of the first free place */
	.zero 1
received_out:                                /* of the oldest byte; the main loop's */
	.zero 1
serial_control:                              /* what UCSR0B is outside of these interrupts */
	.zero 1
serial_next:                                 /* address of the next byte to be sent, while the frame goes out */
	.zero 2

/* 11 cycles up to sei. r24, r25, r30 and r31 are free then, and r25 holds SREG. */
.macro MASK
	push r24
	ldi  r24, MASKED
	sts  UCSR0B, r24
	lds  r24, engine_listens
	sbrs r24, 0
	sei
	push r25                             /* from here on a step interrupt may come */
	in   r25, SREG
	push r30
	push r31
.endm

.macro UNMASK
	pop  r31
	pop  r30
	lds  r24, serial_control
	out  SREG, r25
	pop  r25
	cli
	sts  UCSR0B, r24
	pop  r24
	reti
.endm

	.section .text.step_interrupt, "ax", @progbits

/* A byte for which there is no room is lost: its frame's checksum will tell. */
	.global USART_RX_vect
USART_RX_vect:
	MASK
	lds  r30, received_in
	ldi  r31, 0
	subi r30, lo8(-(received))
	sbci r31, hi8(-(received))
	lds  r24, UDR0
	st   Z, r24                          /* into the free place, whether it is the last one or not */
	lds  r30, received_in
	inc  r30
	andi r30, RECEIVED_BYTES - 1
	lds  r24, received_out
	cpse r30, r24
	sts  received_in, r30
	UNMASK

	.global USART_UDRE_vect
USART_UDRE_vect:
	MASK
	lds  r30, serial_next
	lds  r31, serial_next + 1
	ld   r24, Z+
	sts  UDR0, r24
	sts  serial_next, r30
	sts  serial_next + 1, r31
	tst  r24
	brne 1f
	ldi  r24, RECEIVING                  /* a frame's last byte is its only zero */
	sts  serial_control, r24
1:	UNMASK
