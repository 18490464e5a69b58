#include "boards/timer/timer_registers.h"

#ifdef STEPRAMP_HAS_TIMERS

#include "boards/timer/timer_board.h"
#include "boards/timer/timer_limits.h"
#include "stepramp/edge/board_limits.h"

static const IN_FLASH uint8_t limits[BOARD_LIMITS_BYTES] = BOARD_LIMITS;

const void *stepramp_timer_limits(void)
{
    return (const void *)limits;
}

#else

typedef int board_has_no_such_timer; /* ISO C wants something in each file */

#endif
