/* The chip's Timer2, made of variables, for controller/clock.c on this machine. */
#include <stdint.h>

extern uint8_t TCCR2A, TCCR2B, TCNT2;

enum { CS20 = 0, CS21 = 1, CS22 = 2 };

#define _BV(bit) (1 << (bit))
