/* Makes a ramp on the board itself, from speeds and accelerations: its bytes in a ramp image. */
#ifndef STEPRAMP_RAMP_MAKER_H
#define STEPRAMP_RAMP_MAKER_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct ramp_wish {
    float speed;        /* [steps/s] > 0 */
    float base_speed;   /* [steps/s] at which it begins and ends: at least 0, below the speed */
    float acceleration; /* [steps/s^2] > 0 */
    float deceleration; /* [steps/s^2] > 0 */
    uint32_t clock_hz;  /* of the ticks that it is made of */

    uint16_t segment_ticks; /* what preparing a segment takes: the ramp leaves that time; 0: it needn't */
};

/* To the nearest. */
int32_t ramp_maker_rounded(float number);

/* [ticks], rounded to the nearest. */
uint32_t ramp_maker_interval(uint32_t clock_hz, float speed);

/* [steps] from the base speed to the speed. */
float ramp_maker_steps(const struct ramp_wish *wish, float acceleration);

/* Writes the ramp, of segments: each interval within 1/512 of the exact one and a tick, or within 1/256,
 * 1/128 or 1/64 where there is less room, and down to 1/16 where there is less time to prepare it. Not each one of a long segment is looked
 * at: those between may be off by a little more, as by 6.4 % in place of 6.3. Returns its length [bytes], or 0: even so
 * there is no room, or no time. */
uint16_t ramp_maker_write(const struct ramp_wish *wish, uint8_t *bytes, uint16_t room);

#ifdef __cplusplus
}
#endif

#endif
