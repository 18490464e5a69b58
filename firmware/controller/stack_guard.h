/* The stack grows down towards the last variable. The byte behind that is watched: once the stack has come there, nothing
 * can be trusted any more, and the watchdog begins anew. */
#ifndef STEPRAMP_STACK_GUARD_H
#define STEPRAMP_STACK_GUARD_H

#include <avr/interrupt.h>
#include <stdint.h>

#include "reset.h"

enum { STACK_GUARD = 0xA5 }; /* the simulator paints the stack with it, too: so it counts as untouched */

extern volatile uint8_t __heap_start; /* the linker's */

static inline void stack_guard_begin(void)
{
    __heap_start = STACK_GUARD;
}

/* In each round of the main loop. No step comes until the watchdog does. */
static inline void stack_guard_check(void)
{
    if (__heap_start != STACK_GUARD) {
        cli();
        note_watchdog_reset();
        for (;;) {
        }
    }
}

#endif
