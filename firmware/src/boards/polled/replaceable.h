/* What a sketch that has chosen a timer puts its own in the place of: boards/timer/timer_choice.h. */
#ifndef STEPRAMP_REPLACEABLE_H
#define STEPRAMP_REPLACEABLE_H

#if defined(ARDUINO) && defined(__AVR__)
#define REPLACEABLE __attribute__((weak))
#else
#define REPLACEABLE
#endif

#endif
