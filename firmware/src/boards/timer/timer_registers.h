/* A sketch's step timer in place of the controller's Timer1: in the files of boards/avr/ its registers have the names of
 * Timer1's. Where they are is told by three symbols that the sketch's header defines (timer_choice.h), so that one engine
 * serves each timer. All 16-bit timers have their registers in the same order.
 *
 * On chips whose timers have a third channel, compare B and C play the axes: Arduino's Servo library, once it is linked,
 * has the interrupts of compare A of nearly all timers. */
#ifndef STEPRAMP_TIMER_REGISTERS_H
#define STEPRAMP_TIMER_REGISTERS_H

#if defined(ARDUINO) && defined(__AVR__)

#include <avr/io.h>

#if defined(__AVR_ATmega328P__)
#define STEPRAMP_HAS_TIMERS
#define FIRST_COMPARE_REGISTER 8
#define FIRST_COMPARE_BIT 1
#elif defined(__AVR_ATmega2560__) || defined(__AVR_ATmega32U4__)
#define STEPRAMP_HAS_TIMERS
#define FIRST_COMPARE_REGISTER 10
#define FIRST_COMPARE_BIT 2
#endif

#endif

#ifdef STEPRAMP_HAS_TIMERS

#define STEPRAMP_IN_ASSEMBLY
#define STEPRAMP_IN_A_SKETCH

#undef TCCR1A
#undef TCCR1B
#undef TCNT1
#undef TCNT1L
#undef TCNT1H
#undef OCR1A
#undef OCR1AL
#undef OCR1AH
#undef OCR1B
#undef OCR1BL
#undef OCR1BH
#undef TIFR1
#undef TIMSK1
#undef OCF1A
#undef OCF1B
#undef OCIE1A
#undef OCIE1B
#undef TIMER1_COMPA_vect
#undef TIMER1_COMPB_vect

#define OCF1A FIRST_COMPARE_BIT
#define OCF1B (FIRST_COMPARE_BIT + 1)
#define OCIE1A FIRST_COMPARE_BIT
#define OCIE1B (FIRST_COMPARE_BIT + 1)

#define TIMER1_COMPA_vect stepramp_first_compare
#define TIMER1_COMPB_vect stepramp_second_compare

#ifdef __ASSEMBLER__

/* Arguments of macros have no blanks. */
#define TCNT1L (stepramp_timer+4)
#define TCNT1H (stepramp_timer+5)
#define OCR1AL (stepramp_timer+FIRST_COMPARE_REGISTER)
#define OCR1AH (stepramp_timer+FIRST_COMPARE_REGISTER+1)
#define OCR1BL (stepramp_timer+FIRST_COMPARE_REGISTER+2)
#define OCR1BH (stepramp_timer+FIRST_COMPARE_REGISTER+3)
#define TIFR1 stepramp_timer_flags
#define TIMSK1 stepramp_timer_mask

#else

/* Addresses, but for the flags' register: that has its number among those of `in` and `out`. Weak: where no sketch has
 * chosen a timer there are none, and nobody calls what uses them. */
extern volatile uint8_t stepramp_timer[] __attribute__((weak));
extern volatile uint8_t stepramp_timer_flags[] __attribute__((weak));
extern volatile uint8_t stepramp_timer_mask[] __attribute__((weak));

#define TCCR1A (stepramp_timer[0])
#define TCCR1B (stepramp_timer[1])
#define TCNT1 (*(volatile uint16_t *)(stepramp_timer + 4))
#define OCR1A (*(volatile uint16_t *)(stepramp_timer + FIRST_COMPARE_REGISTER))
#define OCR1B (*(volatile uint16_t *)(stepramp_timer + FIRST_COMPARE_REGISTER + 2))
#define TIFR1 (stepramp_timer_flags[__SFR_OFFSET])
#define TIMSK1 (stepramp_timer_mask[0])

#endif

#endif

#endif
