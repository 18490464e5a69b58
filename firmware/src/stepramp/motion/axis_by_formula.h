/* The motion of an axis whose ramp is computed while it is played: see axis.h and formula.h. */
#ifndef STEPRAMP_AXIS_BY_FORMULA_H
#define STEPRAMP_AXIS_BY_FORMULA_H

#include "stepramp/motion/axis.h"

#ifdef __cplusplus
extern "C" {
#endif

/* As axis_next, of an axis that isn't at rest. What has to be computed for it comes from axis_compute. */
void axis_next_by_formula(struct axis *axis, struct piece *piece);

#ifdef __cplusplus
}
#endif

#endif
