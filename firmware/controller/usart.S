/* The serial port's interrupts: a byte has been received, a byte can be sent. Each lets step interrupts come as soon as it
 * has masked both of them, 15 cycles after its acceptance, and again blocks them only for its last 10. So they don't nest,
 * and the stack needs room for one of them and a step interrupt. 63 and 66 cycles in all, 69 at the end of a frame.
 *
 * Where step interrupts listen, with wide pulses, they are blocked for all of that: they would keep these from their end for
 * too long. */
#define __SFR_OFFSET 0
#include <avr/io.h>

#include "boards/avr/step_interrupt.h"
#include "serial.h"

#define MASKED (1 << RXEN0 | 1 << TXEN0)

	.section .bss
	.global serial_received, serial_received_in, serial_received_out, serial_control, serial_next
serial_received:
	.zero RECEIVED_BYTES
serial_received_in:                          /* number of the next byte, counted modulo 256 */
	.zero 1
serial_received_out:                         /* of the oldest one that has not been taken */
	.zero 1
serial_control:                              /* what UCSR0B is outside of these interrupts */
	.zero 1
serial_next:                                 /* address of the next byte to be sent, while the frame goes out */
	.zero 2

/* 8 cycles up to where a step interrupt may come. r24, r25, r30 and r31 are free then, and r25 holds SREG. */
.macro MASK
	push r24
	ldi  r24, MASKED
	sts  UCSR0B, r24
	sbis GPIOR0, LISTENS
	sei
	nop                                  /* what follows sei is done first: nothing is shorter */
	push r25
	in   r25, SREG
	push r30
	push r31
.endm

	.section .text.step_interrupt, "ax", @progbits

/* A byte for which there is no room takes that of the oldest: that one's frame is lost, and its checksum will tell, but a stop
 * that comes last isn't. The main loop may be taking the oldest byte: then both of them do the same. */
	.global USART_RX_vect
USART_RX_vect:
	MASK
	lds  r30, serial_received_in
	mov  r24, r30
	inc  r24
	sts  serial_received_in, r24
	lds  r31, serial_received_out
	sub  r24, r31
	sbrs r24, RECEIVED_BITS
	rjmp 1f
	inc  r31
	sts  serial_received_out, r31
1:	andi r30, RECEIVED_BYTES - 1
	ldi  r31, 0
	subi r30, lo8(-(serial_received))
	sbci r31, hi8(-(serial_received))
	lds  r24, UDR0
	st   Z, r24
	rjmp unmask

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
	brne unmask
	ldi  r24, RECEIVING                  /* a frame's last byte is its only zero */
	sts  serial_control, r24
unmask:
	pop  r31
	pop  r30
	lds  r24, serial_control
	out  SREG, r25
	pop  r25
	cli
	sts  UCSR0B, r24
	pop  r24
	reti
