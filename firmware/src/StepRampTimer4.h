/* StepRamp's steps are made by the interrupts of Timer4. Include it in one file of the sketch; see StepRamp.h. */
#ifndef STEPRAMP_TIMER4_H
#define STEPRAMP_TIMER4_H

#ifdef STEPRAMP_TIMER_CHOICE_H
#error "Only one of StepRampTimer1.h, StepRampTimer3.h, StepRampTimer4.h and StepRampTimer5.h can be included."
#endif

#ifndef __AVR_ATmega2560__
#error "This board has no Timer4 that StepRamp could use: Timer1 is there on Uno, Nano, Mega, Leonardo and Micro, Timer3 on Mega, Leonardo and Micro, Timer4 and Timer5 on Mega. Without this include steps are made from loop()."
#else

#include "boards/timer/timer_choice.h"

STEPRAMP_TIMER(4)

#endif

#endif
