/* ramp_maker.c on this machine: each line `SPEED BASE_SPEED ACCELERATION DECELERATION ROOM` is answered by the bytes of the
 * ramp in hexadecimal, or `-`: there is no room. */
#include <stdio.h>
#include <stdlib.h>

#include "stepramp/store/ramp_maker.h"

int main(void)
{
    struct ramp_wish wish;
    unsigned room;
    while (scanf("%f %f %f %f %u", &wish.speed, &wish.base_speed, &wish.acceleration, &wish.deceleration, &room) == 5) {
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
