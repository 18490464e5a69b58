/* For a sketch, by one of StepRampTimer1.h, 3, 4 or 5: steps are made by the interrupts of that timer. All is defined here, in the
 * sketch's own object file, and not in the library's: which timer it is, its interrupts, and the engine's functions, in the place of
 * those that are played from loop(). So no timer is taken from a sketch, or from a library such as Servo, that hasn't included it. */
#ifndef STEPRAMP_TIMER_CHOICE_H
#define STEPRAMP_TIMER_CHOICE_H

#include <Arduino.h>
#include <avr/interrupt.h>

#include "boards/timer/timer_board.h"

#if F_CPU != 16000000L
#error "StepRamp's timers want a processor of 16 MHz; without this include steps are made from loop()."
#endif

#if defined(Servo_h) && defined(__AVR_ATmega328P__)
#error "Servo has Timer1, the only timer that StepRamp could have on this board; without this include steps are made from loop()."
#endif

/* The first instruction of both interrupts leads to the engine. What the linker is told is where the registers are. */
#define STEPRAMP_INTERRUPTS_OF(first_vector, second_vector, registers, flags, mask)                                    \
    ISR(first_vector, ISR_NAKED)                                                                                       \
    {                                                                                                                  \
        __asm__ volatile(".global stepramp_timer, stepramp_timer_flags, stepramp_timer_mask\n\t"                       \
                         ".equ stepramp_timer, %0\n\t"                                                                 \
                         ".equ stepramp_timer_flags, %1\n\t"                                                           \
                         ".equ stepramp_timer_mask, %2\n\t"                                                            \
                         "jmp stepramp_first_compare" ::"n"(_SFR_MEM_ADDR(registers)),                                 \
                         "n"(_SFR_IO_ADDR(flags)), "n"(_SFR_MEM_ADDR(mask)));                                          \
    }                                                                                                                  \
    ISR(second_vector, ISR_NAKED)                                                                                      \
    {                                                                                                                  \
        __asm__ volatile("jmp stepramp_second_compare");                                                               \
    }

/* The channels: see timer_registers.h. */
#ifdef __AVR_ATmega328P__
#define STEPRAMP_TIMER(number)                                                                                         \
    STEPRAMP_INTERRUPTS_OF(TIMER##number##_COMPA_vect, TIMER##number##_COMPB_vect, TCCR##number##A, TIFR##number,      \
                           TIMSK##number)
#else
#define STEPRAMP_TIMER(number)                                                                                         \
    STEPRAMP_INTERRUPTS_OF(TIMER##number##_COMPB_vect, TIMER##number##_COMPC_vect, TCCR##number##A, TIFR##number,      \
                           TIMSK##number)
#endif

/* The engine jumps here when there are gauges. */
ISR(__vector_gauges)
{
    stepramp_timer_play_gauges();
}

extern "C" {

/* When the linker finds this twice, one of the StepRampTimer headers is included in two files of the sketch: once is enough. */
extern const uint8_t StepRampTimer_is_included_in_more_than_one_file;
const uint8_t StepRampTimer_is_included_in_more_than_one_file __attribute__((used)) = 0;

void step_queue_begin(void)
{
    stepramp_timer_begin();
}

void step_queue_set_clock(bool fast)
{
    stepramp_timer_set_clock(fast);
}

void step_queue_start(uint8_t axes, uint16_t setup_ticks)
{
    stepramp_timer_start(axes, setup_ticks);
}

void step_queue_halt(uint8_t axes)
{
    stepramp_timer_halt(axes);
}

void step_queue_clear(uint8_t axes)
{
    stepramp_timer_clear(axes);
}

void engine_set_line(bool line)
{
    stepramp_timer_set_line(line);
}

uint8_t engine_running(void)
{
    return stepramp_timer_running();
}

uint16_t engine_now(void)
{
    return stepramp_timer_now();
}

struct engine_progress engine_progress(uint8_t axis)
{
    return stepramp_timer_progress(axis);
}

uint8_t engine_step_mask(uint8_t axis)
{
    return stepramp_timer_step_mask(axis);
}

uint8_t engine_turn_mask(uint8_t axis)
{
    return stepramp_timer_turn_mask(axis);
}

void board_configure(const struct settings *settings)
{
    stepramp_timer_configure(settings);
}

uint16_t board_time(void)
{
    return stepramp_timer_time();
}

const void *arduino_limits(void)
{
    return stepramp_timer_limits();
}

void arduino_end_events(void)
{
    stepramp_timer_end_events();
}

bool arduino_watch_pin(uint8_t pin)
{
    return stepramp_timer_watch_pin(pin);
}

/* There is nothing to be done in loop(). */
void arduino_begin(void)
{
}

void arduino_play(void)
{
}

void arduino_use_gauges(void)
{
    stepramp_timer_use_gauges();
}

bool arduino_has_timer(void)
{
    return true;
}

uint32_t arduino_delayed_us(void)
{
    return 0;
}
}

#endif
