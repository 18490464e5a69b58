/* Gauge motors (Switec X25, X27 and alike) whose coils are connected to the pins: up to three, on D2..D5, D6..D9 and
 * D10..D13. They are slow, so they are played in C, from the same queues, by compare B. */
#ifndef STEPRAMP_GAUGE_H
#define STEPRAMP_GAUGE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define GAUGES 3

/* At rest: the pins become coils, at the pattern where each gauge is; every direction is forward. */
void gauges_configure(void);

/* The same promises as the engine's functions without `s`, for parked axes with segments. */
void gauges_start(uint8_t axes, uint16_t delay_ticks);
void gauges_halt(uint8_t axes);
uint8_t gauges_running(void);

#ifdef __cplusplus
}
#endif

#endif
