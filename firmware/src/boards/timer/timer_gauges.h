/* What a sketch's timer does for gauges. */
#ifndef STEPRAMP_TIMER_GAUGES_H
#define STEPRAMP_TIMER_GAUGES_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct timer_gauges {
    void (*configure)(void);
    void (*release)(void);
    void (*start)(uint8_t axes, uint16_t delay_ticks);
    void (*halt)(uint8_t axes);
    uint8_t (*running)(void);
    void (*play)(void);
};

/* None before stepramp_timer_use_gauges(). */
extern const struct timer_gauges *stepramp_gauges;

#ifdef __cplusplus
}
#endif

#endif
