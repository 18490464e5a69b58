/* frame.c's share of each byte that comes in, in 60 cycles at most before it ends a frame: with motors at their limits
 * the main loop has a tenth of the processor, and a stop waits until all that came before it has been read. */
#ifdef STEPRAMP_IN_ASSEMBLY

#define __SFR_OFFSET 0
#include <avr/io.h>

/* struct frame_receiver; and counts as in frame.c */
#define TAIL 0
#define COUNT 2
#define GROUP_LEFT 3
#define CRC 4
#define EMPTY_COUNT 3
#define LONGEST_COUNT 59
#define HAS_BYTE 0xFF
#define STOPS 0xFE
#define HALT_BYTE 0xFE

/* The CRC in \high and \low continued by what \high has been xored with. Uses \high, \scratch; the next one is in
 * \scratch (low) and \low (high). 14 cycles. */
.macro CONTINUE_CRC high, low, scratch
	mov  \scratch, \high
	swap \scratch
	andi \scratch, 0x0F
	eor  \high, \scratch
	mov  \scratch, \high
	swap \scratch
	andi \scratch, 0xF0
	eor  \low, \scratch
	lsl  \scratch
	eor  \scratch, \high
	lsr  \high
	lsr  \high
	lsr  \high
	eor  \low, \high
.endm

	.section .text.frame_receive, "ax", @progbits

/* uint16_t frame_receive(struct frame_receiver *receiver, uint8_t byte) */
	.global frame_receive
frame_receive:
	movw r30, r24
	ldd  r25, Z+COUNT
	ldd  r24, Z+GROUP_LEFT
	tst  r22
	breq end_of_frame
	subi r24, 1
	brcc 1f
	mov  r24, r22                        /* a code byte stands for the zero before its group */
	dec  r24
	clr  r22
	tst  r25
	breq begin_frame
1:	std  Z+GROUP_LEFT, r24
	ld   r20, Z
	ldd  r21, Z+TAIL+1
	st   Z, r21
	std  Z+TAIL+1, r22
	cpi  r25, LONGEST_COUNT+1
	adc  r25, r1                         /* beyond it is too long, and stays so */
	std  Z+COUNT, r25
	subi r25, EMPTY_COUNT+1
	cpi  r25, LONGEST_COUNT-EMPTY_COUNT
	brsh goes_on
	ldd  r18, Z+CRC
	ldd  r19, Z+CRC+1
	eor  r19, r20
	CONTINUE_CRC r19, r18, r24
	std  Z+CRC, r24
	std  Z+CRC+1, r18
	mov  r25, r20
	ldi  r24, HAS_BYTE
	ret

begin_frame:
	std  Z+GROUP_LEFT, r24
	ldi  r24, 1
	std  Z+COUNT, r24
	ldi  r24, 0xFF                       /* CRC16_START */
	std  Z+CRC, r24
	std  Z+CRC+1, r24
goes_on:
	ldi  r24, 0
	ldi  r25, 0
	ret

/* r24 is 0 between groups. Gives the length of a good message. */
end_of_frame:
	std  Z+COUNT, r1
	std  Z+GROUP_LEFT, r1
	cpi  r25, 2
	breq two_bytes
	ld   r18, Z
	ldd  r19, Z+TAIL+1
	ldd  r20, Z+CRC
	ldd  r21, Z+CRC+1
	cp   r18, r20
	cpc  r19, r21
	brne goes_on
	subi r25, EMPTY_COUNT
	cpi  r25, LONGEST_COUNT-EMPTY_COUNT+1
	brsh goes_on
	tst  r24
	brne goes_on
	mov  r24, r25
	ldi  r25, 0
	ret

two_bytes:
	ldd  r25, Z+TAIL+1
	subi r24, -2                         /* the first one */
	cp   r24, r25
	brne goes_on
	cpi  r25, HALT_BYTE
	brcs goes_on
	ldi  r24, STOPS
	ret

	.section .text.frame_crc16_update, "ax", @progbits

/* uint16_t frame_crc16_update(uint16_t crc, uint8_t byte) */
	.global frame_crc16_update
frame_crc16_update:
	eor  r25, r22
	CONTINUE_CRC r25, r24, r22
	mov  r25, r24
	mov  r24, r22
	ret

#endif
