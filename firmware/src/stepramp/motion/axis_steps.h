/* Shared between the motion of an axis along segments (axis.c) and by formula (axis_by_formula.c). For no one else. */
#ifndef STEPRAMP_AXIS_STEPS_H
#define STEPRAMP_AXIS_STEPS_H

#include "stepramp/motion/axis.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Steps from here to the target; 0 when it isn't ahead. A run has always more of them in its direction. */
uint32_t axis_steps_left(const struct axis *axis);

/* The commanded speed has become lower than the present one. */
bool axis_is_too_fast(const struct axis *axis);

/* Puts into a piece as many of `count` intervals, the first `interval` long, each next one longer by `add`, as it may have:
 * at least one. */
void axis_fit_steps(struct piece *piece, uint32_t interval, int16_t add, uint32_t count);

/* Gives the steps that have been put into a piece, and moves the axis along them. */
void axis_give_steps(struct axis *axis, struct piece *piece);

#ifdef __cplusplus
}
#endif

#endif
