/* Gauges by the interrupt of a sketch's timer. Functions are reached through a table, so that a sketch without gauges has none of
 * them. */
#include "boards/timer/timer_registers.h"

#ifdef STEPRAMP_HAS_TIMERS

#include "boards/avr/gauge.c"
#include "boards/timer/timer_gauges.h"

/* In arduino_board.cpp */
void arduino_release_gauges(void);

void stepramp_timer_use_gauges(void)
{
    static const struct timer_gauges functions = {gauges_configure, arduino_release_gauges, gauges_start,
                                                  gauges_halt,      gauges_running,         play_gauges};
    stepramp_gauges = &functions;
}

#else

typedef int board_has_no_such_timer; /* ISO C wants something in each file */

#endif
