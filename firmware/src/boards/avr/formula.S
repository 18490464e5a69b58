#ifdef STEPRAMP_IN_ASSEMBLY

; The hot part of formula.c for an AVR that multiplies: formula_step, equal bit for bit to the C there.
;
; There is one loop for formulas (20) and (23), and one for Newton's method. x^2 moves by whole bytes with the exponent of
; x, so that no loop shifts bits: Newton's method takes other bytes of k, and the formulas end their two additions in a
; tail of code for each direction and exponent. Both loops share the output. What happens once in thousands of steps,
; that x gets to another exponent, is out of line. That an interval stays within the ramp is left to formula.c.
;
; Names of several bytes are numbered from the lowest. Cycles are in brackets.

#include <avr/io.h>

#include "stepramp/motion/formula.h"

#define zero    r4
#define X0      r16     /* mantissa of x; here because fmul only takes r16 to r23 */
#define X1      r17
#define X2      r18
#define X3      r19
#define M0      r6      /* multiplier of the output, and its highest byte rounded */
#define M1      r7
#define M2      r8
#define M2_ROUNDED r9
#define flags   r28
#define count   r29     /* intervals that are still to be computed */
/* The next interval goes to X, r27:r26. */

/* flags: those of formula.h, the exponent, and the bytes of fraction of the output */
#define DOWN_BIT 0
#define COMPROMISE_BIT 1
#define NEWTON_BIT 2
#define EXPONENT_ONE 0x10
#define EXPONENT_MASK 0x30
#define THREE_BYTES_BIT 3 /* where the number is odd */
#define ODD_BYTES_BIT 6
#define TWO_BYTES_BIT 7 /* which is usual */

#define B0      r10     /* while the output is computed; products before that */
#define B1      r11
#define B2      r12
#define B3      r13

/* Newton's method. */
#define K0      r2      /* the four bytes of k that count with the exponent: 8 bits whole with it */
#define K1      r3
#define K2      r5
#define K3      r15
#define GAIN0   r24     /* what is taken off them: 1 or -1 */
#define GAIN1   r25
#define GAIN2   r30
#define GAIN3   r31

/* Formulas (20) and (23). */
#define TAIL    r2      /* and r3: address of the tails of the direction and the exponent */
#define three   r5
#define FACTOR_TAIL_WORDS 5
#define CHANGE_TAIL_WORDS 8

/* Free where nothing is being computed. */
#define T0      r20
#define T1      r21

.section .text.formula, "ax", @progbits

; ---------------------------------------------------------------------------------------------------------------------
; The output: interval = (X3:X2) * M / 2^8 + X1 * M2_ROUNDED, rounded to whole ticks. (53 or 54 with two bytes of fraction)

.macro add_at_0                 ; adds the last product to B (4)
        add     B0, r0
        adc     B1, r1
        adc     B2, zero
        adc     B3, zero
.endm

.macro add_at_1                 ; the same, one byte higher (3)
        add     B1, r0
        adc     B2, r1
        adc     B3, zero
.endm

to_done: rjmp    done
output:
        mul     X3, M2
        movw    B2, r0
        mul     X2, M1
        movw    B0, r0
        mul     X2, M0
        add     B0, r1          ; no carry beyond B1: X2 * (M1:M0) is of 24 bits
        adc     B1, zero
        mul     X1, M2_ROUNDED
        add_at_0
        mul     X3, M0
        add_at_0
        mul     X2, M2
        add_at_1
        mul     X3, M1
        add_at_1                ; (32)
        sbrs    flags, TWO_BYTES_BIT
        rjmp    other_fraction
        lsl     B1              ; half a tick and more are one
        movw    B0, B2
        adc     B0, zero
        adc     B1, zero
store_17_bits:
        clr     B2              ; leaves the carry
        clr     B3
        rol     B2
store:  st      X+, B0
        st      X+, B1
        st      X+, B2
        st      X+, B3          ; (17)
        dec     count
        breq    to_done
next:   sbrc    flags, NEWTON_BIT
        rjmp    newton          ; (4 or 5)

; ---------------------------------------------------------------------------------------------------------------------
; Formulas (20) and (23): x (1 - q) and x (1 - q + q^2), or with + on the ramp down. (94 for (23), 71 for (20))

#define Q0      r20     /* q = x^2, in Q3:Q2:Q1; then the factor of x */
#define Q1      r21
#define Q2      r22
#define Q3      r23
#define A0      r20     /* x, with 24 bits */
#define A1      r24
#define A2      r25
#define S0      r10     /* square of Q3:Q2 */
#define S1      r11
#define S2      r12
#define S3      r13
#define P0      r14     /* product of x and its factor */
#define P0_CARRY r15
#define P1      r10
#define P2      r11
#define P3      r12
#define P4      r13

.macro square_of low, high, s0, s1, s2, s3      ; the carry of fmul is bit 16 of 2 * low * high
        mul     \low, \low
        movw    \s0, r0
        mul     \high, \high
        movw    \s2, r0
        fmul    \high, \low
        adc     \s3, zero       ; (9)
.endm

taylor: movw    r30, TAIL
        square_of X2, X3, Q0, Q1, Q2, Q3
        lsl     Q0              ; rounded to 24 bits
        adc     Q1, r0
        adc     Q2, r1
        adc     Q3, zero        ; (14)
        mov     A0, X1          ; A = (X3:X2) * 2^8 + 3 * (X1 | 1)
        ori     A0, 1
        mul     A0, three
        movw    A1, X2
        mov     A0, r0
        add     A1, r1
        adc     A2, zero        ; (8)
        brtc    product
        square_of Q2, Q3, S0, S1, S2, S3
        add     S1, r0
        adc     S2, r1
        adc     S3, zero
        add     S0, Q2          ; and Q3:Q2 itself: (q + 1/2)^2 but for the 1/4
        adc     S1, Q3
        adc     S2, zero
        adc     S3, zero
        ijmp                    ; factor_tail, which goes on with product (25)
product:
        mul     A1, Q2          ; P = (A2:A1) * (Q3:Q2:Q1) + A0 * (Q3:Q2)
        movw    P1, r0
        mul     A1, Q1
        movw    P0, r0
        mul     A0, Q2
        add     P0, r0
        adc     P0_CARRY, r1    ; belongs to P1
        adc     P2, zero
        mul     A2, Q3
        movw    P3, r0
        mul     A2, Q2
        add     P1, P0_CARRY
        adc     P2, r0
        adc     P3, r1
        adc     P4, zero
        mul     A1, Q3
        add     P2, r0
        adc     P3, r1
        adc     P4, zero
        mul     A2, Q1
        add     P1, r0
        adc     P2, r1
        adc     P3, zero
        adc     P4, zero
        mul     A0, Q3
        add     P1, r0
        adc     P2, r1
        adc     P3, zero
        adc     P4, zero        ; (37)
        adiw    r30, FACTOR_TAIL_WORDS
        ijmp                    ; change_tail (4)

; What is added to or taken off the factor, then x: whole bytes of S and P by the exponent, the byte below them rounded.
; All tails are of one size.

.macro factor_tail instruction, rounded, b1, b2, b3
        lsl     \rounded
        \instruction Q1, \b1
        \instruction Q2, \b2
        \instruction Q3, \b3
        rjmp    product
.endm

.macro change_x instruction, rounded, b0, b1, b2, b3
        lsl     \rounded
        \instruction X0, \b0
        \instruction X1, \b1
        \instruction X2, \b2
        \instruction X3, \b3
.endm

.macro change_tail_up rounded, b0, b1, b2, b3
        change_x sbc, \rounded, \b0, \b1, \b2, \b3
        cpi     X3, LEAST_MANTISSA_BYTE
        brcs    to_next_exponent
        rjmp    output
.endm

.macro change_tail_down rounded, b0, b1, b2, b3
        change_x adc, \rounded, \b0, \b1, \b2, \b3
        cpi     X3, MANTISSA_LIMIT_BYTE
        brcc    to_exponent_before
        rjmp    output
.endm

to_next_exponent:
        rjmp    next_exponent
tails:
        factor_tail sbc, S0, S1, S2, S3
        change_tail_up P0, P1, P2, P3, P4
        factor_tail sbc, S1, S2, S3, zero
        change_tail_up P1, P2, P3, P4, zero
        factor_tail sbc, S2, S3, zero, zero
        change_tail_up P2, P3, P4, zero, zero
        factor_tail sbc, S3, zero, zero, zero
        change_tail_up P3, P4, zero, zero, zero
        factor_tail adc, S0, S1, S2, S3
        change_x adc, P0, P1, P2, P3, P4
        brcs    saturated       ; at other exponents it can't be: x^2 is below 1/256
        rjmp    output
        nop
        factor_tail adc, S1, S2, S3, zero
        change_tail_down P1, P2, P3, P4, zero
        factor_tail adc, S2, S3, zero, zero
        change_tail_down P2, P3, P4, zero, zero
        factor_tail adc, S3, zero, zero, zero
        change_tail_down P3, P4, zero, zero, zero
to_exponent_before:
        rjmp    exponent_before

; Beyond 1: x stays as long as it can be.
saturated:
        ldi     X0, 0xFF
        ldi     X1, 0xFF
        movw    X2, X0
        rjmp    output

other_fraction:
        sbrs    flags, ODD_BYTES_BIT
        rjmp    store           ; no fraction
        sbrc    flags, THREE_BYTES_BIT
        rjmp    three_bytes
        lsl     B0
        mov     B0, B1
        mov     B1, B2
        mov     B2, B3
        mov     B3, zero
        adc     B0, zero
        adc     B1, zero
        adc     B2, zero
        adc     B3, zero
        rjmp    store
three_bytes:
        lsl     B2
        mov     B0, B3
        mov     B1, zero
        adc     B0, zero
        adc     B1, zero
        rjmp    store_17_bits

; ---------------------------------------------------------------------------------------------------------------------
; Beginning and end. The pointers to x and, on top, to the side stay on the stack.

done:   pop     r0
        pop     r0
        pop     r31
        pop     r30
        st      Z, X0
        std     Z+1, X1
        std     Z+2, X2
        std     Z+3, X3
        swap    flags
        andi    flags, EXPONENT_MASK >> 4
        std     Z+4, flags
        clr     r1
        in      r28, _SFR_IO_ADDR(SPL)
        in      r29, _SFR_IO_ADDR(SPH)
        ldi     r30, 18
        jmp     __epilogue_restores__

.global formula_step
.type formula_step, @function
formula_step:
        ldi     r26, 0          ; all registers that are to be saved, and nothing else
        ldi     r27, 0
        ldi     r30, lo8(pm(1f))
        ldi     r31, hi8(pm(1f))
        jmp     __prologue_saves__
1:      clr     zero
        push    r24
        push    r25
        push    r22
        push    r23
        mov     flags, r16
        mov     count, r18
        movw    r26, r20
        movw    r30, r24
        ld      X0, Z
        ldd     X1, Z+1
        ldd     X2, Z+2
        ldd     X3, Z+3
        ldd     T0, Z+4
        swap    T0
        or      flags, T0
        movw    r30, r22
        ldd     K0, Z+SIDE_INDEX_AT
        ldd     K1, Z+SIDE_INDEX_AT+1
        ldd     K2, Z+SIDE_INDEX_AT+2
        mov     K3, r12         ; r14:r13:r12 is the argument `index`
        rjmp    2f
1:      mov     K0, K1
        mov     K1, K2
        mov     K2, K3
        mov     K3, r13
        mov     r13, r14
        clr     r14
2:      subi    T0, EXPONENT_ONE
        brcc    1b
        rcall   load_exponent
        rjmp    next

.macro load_side                 ; Z = side
        pop     r31
        pop     r30
        push    r30
        push    r31
.endm

; x is below 15/256: goes on with the next exponent.
next_exponent:
        ldi     T0, 4
1:      lsl     X0
        rol     X1
        rol     X2
        rol     X3
        dec     T0
        brne    1b
        mov     K0, K1
        mov     K1, K2
        mov     K2, K3
        clr     K3
        load_side
        subi    flags, 0 - EXPONENT_ONE
        rcall   load_exponent
        rjmp    output

; x, or x and the carry, is 240/256 or more: goes on with the exponent before.
exponent_before:
        ldi     T0, 4           ; leaves the carry
1:      ror     X3
        ror     X2
        ror     X1
        ror     X0
        clc
        dec     T0
        brne    1b
        subi    flags, EXPONENT_ONE
        mov     K3, K2
        mov     K2, K1
        mov     K1, K0
        load_side
        rcall   load_exponent_number
        add     r30, T0
        adc     r31, zero
        ldd     K0, Z+SIDE_INDEX_AT
        load_side
        rcall   load_exponent
        rjmp    output

load_exponent_number:
        mov     T0, flags
        swap    T0
        andi    T0, EXPONENT_MASK >> 4
        ret

; All that depends on the exponent. Z: side.
load_exponent:
        rcall   load_exponent_number
        mov     T1, T0
        lsl     T1
        lsl     T1
        add     r30, T1
        adc     r31, zero
        ldd     M0, Z+SIDE_OUTPUTS_AT
        ldd     M1, Z+SIDE_OUTPUTS_AT+1
        ldd     M2, Z+SIDE_OUTPUTS_AT+2
        ldd     T1, Z+SIDE_OUTPUTS_AT+3
        mov     M2_ROUNDED, M1
        lsl     M2_ROUNDED
        mov     M2_ROUNDED, M2
        adc     M2_ROUNDED, zero
        bst     T1, 0
        bld     flags, ODD_BYTES_BIT
        bst     T1, 1
        bld     flags, THREE_BYTES_BIT
        sbrc    T1, 0
        clt
        bld     flags, TWO_BYTES_BIT
        sbrc    flags, NEWTON_BIT
        rjmp    load_gain
        sbrc    flags, DOWN_BIT
        subi    T0, 0 - 4
        ldi     T1, FACTOR_TAIL_WORDS + CHANGE_TAIL_WORDS
        mul     T0, T1
        ldi     r30, lo8(pm(tails))
        ldi     r31, hi8(pm(tails))
        add     r30, r0
        adc     r31, r1
        movw    TAIL, r30
        ldi     T0, 3
        mov     three, T0
        bst     flags, COMPROMISE_BIT
        ret

; What is taken off k: -1 up, 1 down.
load_gain:
        clr     GAIN0
        clr     GAIN1
        clr     GAIN2
        ldi     GAIN3, 0xFF
        ldi     T1, 0xFF
        sbrc    flags, DOWN_BIT
        ldi     T1, 0
        sbrc    flags, DOWN_BIT
        ldi     GAIN3, 1
1:      subi    T0, 1
        brcs    2f
        mov     GAIN0, GAIN1
        mov     GAIN1, GAIN2
        mov     GAIN2, GAIN3
        mov     GAIN3, T1
        rjmp    1b
2:      ret

; ---------------------------------------------------------------------------------------------------------------------
; Newton's method: x + x (1/2 - k x^2), with x rounded to 16 bits. (117 to 120)

#define E0      r20     /* |1/2 - k x^2| */
#define E1      r21
#define E2      r22
; P is k x^2 in 2^-32; then P4:P3:P2:P1 is x times the error.

.macro add_product_at_0         ; (5)
        add     P0, r0
        adc     P1, r1
        adc     P2, zero
        adc     P3, zero
        adc     P4, zero
.endm
.macro add_product_at_1         ; (4)
        add     P1, r0
        adc     P2, r1
        adc     P3, zero
        adc     P4, zero
.endm
.macro add_product_at_2         ; (3)
        add     P2, r0
        adc     P3, r1
        adc     P4, zero
.endm

newton: sub     K0, GAIN0
        sbc     K1, GAIN1
        sbc     K2, GAIN2
        sbc     K3, GAIN3
        lsl     X1
        adc     X2, zero
        adc     X3, zero
        square_of X2, X3, Q0, Q1, Q2, Q3
        add     Q1, r0
        adc     Q2, r1
        adc     Q3, zero        ; (19)
        mul     K3, Q3          ; P = K3 * Q + K2 * Q / 2^8 + K1 * Q / 2^16 + K0 * Q / 2^24, of whole bytes of Q
        movw    P3, r0
        mul     K3, Q1
        movw    P1, r0
        mul     K3, Q0
        mov     P0, r0
        add     P1, r1
        adc     P2, zero
        mul     K0, Q3
        add     P0, r0          ; no carry beyond P2: 255 * 65535 + 255 * 255 is of 24 bits
        adc     P1, r1
        adc     P2, zero
        mul     K2, Q1
        add_product_at_0
        mul     K1, Q2
        add_product_at_0
        mul     K2, Q2
        add_product_at_1
        mul     K1, Q3
        add_product_at_1
        mul     K3, Q2
        add_product_at_2
        mul     K2, Q3
        add_product_at_2        ; (52)
        sbrc    P3, 7
        rjmp    too_long
        tst     P4
        brne    too_long
        clt                     ; P is below 2^31: E = (2^31 - P) / 2^8
        clr     E0
        clr     E1
        ldi     E2, 0x80
        cp      zero, P0        ; what is below 2^8, if anything, makes it one less
        sbc     E0, P1
        sbc     E1, P2
        sbc     E2, P3          ; (12)
times_error:
        mul     X3, E2          ; P4:P3:P2:P1 = X3:X2 * E / 2^8
        movw    P3, r0
        mul     X2, E1
        movw    P1, r0
        mul     X2, E0
        add     P1, r1          ; no carry beyond P2
        adc     P2, zero
        mul     X3, E0
        add_product_at_1
        mul     X2, E2
        add_product_at_2
        mul     X3, E1
        add_product_at_2        ; (26)
        brts    shorten
        movw    X0, P1
        add     X2, P3
        adc     X3, P4
        brcs    at_limit
        cpi     X3, MANTISSA_LIMIT_BYTE
        brcc    at_limit
        rjmp    output
too_long:
        set                     ; E = (P - 2^31) / 2^8
        movw    E0, P1
        mov     E2, P3
        subi    E2, 0x80
        rjmp    times_error
shorten:
        clr     X0
        clr     X1
        sub     X0, P1
        sbc     X1, P2
        sbc     X2, P3
        sbc     X3, P4
        cpi     X3, LEAST_MANTISSA_BYTE
        brcs    1f
        cpi     X3, MANTISSA_LIMIT_BYTE
        brcc    at_limit        ; x was rounded up to the limit, and E is 0
        rjmp    output
1:      rjmp    next_exponent

; At exponent 0 there is no other before, and only with the carry x is beyond 1.
at_limit:
        mov     T0, flags       ; leaves the carry
        andi    T0, EXPONENT_MASK
        breq    2f
        rjmp    exponent_before
2:      brcs    3f
        rjmp    output
3:      rjmp    saturated

; ---------------------------------------------------------------------------------------------------------------------
; x times a ratio, one byte of that after the other: the product is in H3:H2:H1:H0, and what has been shifted out in BELOW.

#define F       r26     /* byte of the ratio */
#define H0      r22
#define H1      r23
#define H2      r24
#define H3      r25
#define H4      r27
#define BYTES   r28
#define BELOW   r29
#define none    r15     /* 0 */
#define Y0      r18     /* mantissa of x */
#define Y1      r19
#define Y2      r20
#define Y3      r21

.global formula_multiply
.type formula_multiply, @function
formula_multiply:
        push    none
        push    r28
        push    r29
        push    r24
        push    r25
        movw    r26, r24
        movw    r30, r22
        ld      Y0, X+
        ld      Y1, X+
        ld      Y2, X+
        ld      Y3, X
        clr     none
        clr     H0
        clr     H1
        movw    H2, H0
        ldi     BYTES, 4
1:      ld      F, Z+
        mul     Y0, F
        clr     H4
        add     H0, r0
        adc     H1, r1
        adc     H2, none
        adc     H3, none
        adc     H4, none
        mul     Y2, F
        add     H2, r0
        adc     H3, r1
        adc     H4, none
        mul     Y1, F
        add     H1, r0
        adc     H2, r1
        adc     H3, none
        adc     H4, none
        mul     Y3, F
        add     H3, r0
        adc     H4, r1
        mov     BELOW, H0
        mov     H0, H1
        mov     H1, H2
        mov     H2, H3
        mov     H3, H4
        dec     BYTES
        brne    1b
        clr     r1
        pop     r27
        pop     r26
        ld      r18, Z           ; exponents
        movw    r30, r26
        ldd     r19, Z+4
        sub     r19, r18
        cpi     H3, LEAST_MANTISSA_BYTE
        brcc    3f
        inc     r19
        ldi     r18, 4
2:      lsl     BELOW
        rol     H0
        rol     H1
        rol     H2
        rol     H3
        dec     r18
        brne    2b
3:      st      Z, H0
        std     Z+1, H1
        std     Z+2, H2
        std     Z+3, H3
        std     Z+4, r19
        pop     r29
        pop     r28
        pop     none
        ret

#endif
