/* The serial port's receive interrupt. It lets step interrupts come as soon as it has masked itself, 14 cycles after its
 * acceptance, and again blocks them only for its last 10. 58 cycles in all. A byte for which there is no room is lost:
 * its frame's checksum will tell. */
#define __SFR_OFFSET 0
#include <avr/io.h>

#include "serial.h"

#define MASKED (1 << RXEN0 | 1 << TXEN0)
#define UNMASKED (1 << RXCIE0 | MASKED)

	.section .bss
	.global received, received_in, received_out
received:
	.zero RECEIVED_BYTES
received_in:                                 /* index of the first free place */
	.zero 1
received_out:                                /* of the oldest byte; the main loop's */
	.zero 1

	.section .text.step_interrupt, "ax", @progbits

	.global USART_RX_vect
USART_RX_vect:
	push r24
	ldi  r24, MASKED
	sts  UCSR0B, r24
	sei
	push r25                             /* from here on a step interrupt may come */
	in   r25, SREG
	push r25
	push r30
	push r31
	lds  r30, received_in
	mov  r25, r30
	inc  r25
	andi r25, RECEIVED_BYTES - 1
	ldi  r31, 0
	subi r30, lo8(-(received))
	sbci r31, hi8(-(received))
	lds  r24, UDR0
	st   Z, r24                          /* into the free place, whether it is the last one or not */
	lds  r24, received_out
	cpse r25, r24
	sts  received_in, r25
	pop  r31
	pop  r30
	pop  r25
	ldi  r24, UNMASKED
	out  SREG, r25
	pop  r25
	cli
	sts  UCSR0B, r24
	pop  r24
	reti
