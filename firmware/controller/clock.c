/* Milliseconds, from Timer2: it counts freely, a tick is 64 us, and 16 ms later it begins anew. */
#include "clock.h"

#include <avr/io.h>

#include "stepramp/edge/board.h"

/* 64 us and 1 ms, in their common unit of 8 us */
enum { UNITS_PER_TICK = 8, UNITS_PER_MS = 125 };

static uint8_t last_count;
static uint16_t ticks;
static uint16_t ticks_in_milliseconds; /* those that are counted there already */
static uint16_t units;                 /* since the last whole millisecond */
static uint16_t milliseconds;

void clock_begin(void)
{
    TCCR2A = 0;
    TCCR2B = _BV(CS22) | _BV(CS21) | _BV(CS20);
}

uint16_t board_time(void)
{
    uint8_t count = TCNT2;
    ticks = (uint16_t)(ticks + (uint8_t)(count - last_count));
    last_count = count;
    return ticks;
}

uint16_t board_milliseconds(void)
{
    uint16_t now = board_time();
    units = (uint16_t)(units + (uint16_t)(now - ticks_in_milliseconds) * UNITS_PER_TICK);
    ticks_in_milliseconds = now;
    while (units >= UNITS_PER_MS) {
        units = (uint16_t)(units - UNITS_PER_MS);
        milliseconds++;
    }
    return milliseconds;
}
