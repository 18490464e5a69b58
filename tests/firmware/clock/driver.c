/* The controller's clock on this machine. Reads SECONDS LONGEST, plays so long a time, in which it is asked after 1 to
 * LONGEST ticks of 64 us each time, now for the one time and now for the other, and says how far it has gone wrong at most:
 * `TICKS MILLISECONDS`. */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "avr/io.h"
#include "clock.h"
#include "stepramp/edge/board.h"

uint8_t TCCR2A, TCCR2B, TCNT2;

static uint16_t wrong(uint64_t exact, uint16_t told)
{
    uint16_t more = (uint16_t)(told - exact), less = (uint16_t)(exact - told);
    return more < less ? more : less;
}

int main(void)
{
    uint64_t seconds, ticks = 0, random = 1;
    unsigned longest, most_ticks = 0, most_ms = 0;
    if (scanf("%lu %u", &seconds, &longest) != 2) {
        return 2;
    }
    clock_begin();
    while (ticks < seconds * 15625) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        ticks += 1 + (random >> 33) % longest;
        TCNT2 = (uint8_t)ticks;
        bool asks_for_ticks = (random >> 32 & 1) != 0;
        unsigned by = asks_for_ticks ? wrong(ticks, board_time()) : wrong(ticks * 8 / 125, board_milliseconds());
        unsigned *most = asks_for_ticks ? &most_ticks : &most_ms;
        *most = by > *most ? by : *most;
    }
    printf("%u %u\n", most_ticks, most_ms);
    return 0;
}
