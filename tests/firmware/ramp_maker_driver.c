/* ramp_maker.c on this machine: each line `SPEED BASE_SPEED ACCELERATION DECELERATION CLOCK_HZ ROOM` is answered by the bytes of the
 * ramp in hexadecimal, or `-`: there is no room. */
#include <stdio.h>
#include <stdlib.h>

#include "stepramp/store/ramp_maker.h"

int main(void)
{
    struct ramp_wish wish = {0};
    unsigned room, clock_hz;
    while (scanf("%f %f %f %f %u %u", &wish.speed, &wish.base_speed, &wish.acceleration, &wish.deceleration, &clock_hz, &room) == 6) {
        wish.clock_hz = clock_hz;
        uint8_t *bytes = malloc(room + 1); /* so that the sanitizer sees a write past the end */
        uint16_t length = ramp_maker_write(&wish, bytes, (uint16_t)room);
        for (uint16_t i = 0; i < length; i++) {
            printf("%02x", bytes[i]);
        }
        printf(length == 0 ? "-\n" : "\n");
        fflush(stdout);
        free(bytes);
    }
    return 0;
}
