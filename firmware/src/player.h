/* Plays moves: turns a ramp into the instants of steps. The main loop plans, starts and stops a move; the interrupt of
 * the step timer plays it, event by event. An event is a pulse, a silent one (a long interval is waited for in parts)
 * or the end of the last interval. */
#ifndef STEPRAMP_PLAYER_H
#define STEPRAMP_PLAYER_H

#include <stdbool.h>
#include <stdint.h>

#include "ramp.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- for the main loop ---- */

enum motor_state { MOTOR_IDLE = 0, MOTOR_MOVING = 1, MOTOR_STOPPING = 2 };

struct motor_report {
    enum motor_state state;
    int32_t position;    /* [steps] */
    int32_t target;      /* [steps] where the motor will come to rest; at rest the position */
    uint32_t interval;   /* [ticks] the present one; 0 at rest */
    uint32_t steps_made; /* in this move, or the last one */
};

/* Begins a move of 1 step or more. The motor must be at rest, and the ramp must stay as it is until it is again. */
void player_move(const struct ramp *ramp, uint32_t steps, bool forward);

/* Slows down with the ramp. At rest, and when it stops already, this does nothing. */
void player_stop(void);

/* No step comes after this. */
void player_halt(void);

/* To be called in each round of the main loop: finds the way down when the motor is to stop. */
void player_poll(void);

bool player_is_moving(void);
struct motor_report player_report(void);

/* ---- for the port's interrupt ---- */

/* Longest time between two events [ticks]: below 2^15, so that a 16-bit timer tells past from future. */
#define PLAYER_LONGEST_WAIT_TICKS 32767u

/* The next event is a pulse: the port begins it with the step pin. */
bool player_pulse_is_due(void);

/* Serves an event. Returns the ticks from this event to the next one; 0 when the motor is at rest now. */
uint16_t player_event(void);

#ifdef __cplusplus
}
#endif

#endif
