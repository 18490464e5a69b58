"""As much of a move as decides what its motor makes of it: a long slew phase adds nothing once the rotor is calm."""

import math
from fractions import Fraction

from stepramp.design import Design
from stepramp.motor.bounds import refuse_too_long
from stepramp.motor.torque import drive_train
from stepramp.ramp.plan import real_ramp

SLEW_PERIODS = 40
"""So much of a longer slew phase is played [natural periods]."""


def shortened(design: Design) -> Design:
    """Return the design with as much of a long slew phase as decides the verdict.

    After 40 natural periods what the ramp has stirred up is gone: with ζ = .02 it falls by e^-5. As many whole
    electrical periods are left out, so that the ramp down begins at the same place of one. Raises Rejected without
    a motor, and, unless it is short anyway, as real_ramp does and for what is too long to be played whole.
    """
    train, steps = drive_train(design), abs(design.move.steps)
    periods_s = SLEW_PERIODS / train.natural_frequency_hz
    if not design.method.plays_table and steps <= periods_s * design.ramp.slew_speed_steps_per_s:
        return design  # Most points of a map; whose ramp is then made once.
    ramp = real_ramp(design)
    refuse_too_long(design, ramp)
    slew_steps = math.ceil(periods_s * design.timer.frequency_hz / ramp.slew)
    whole_periods = (Fraction(train.steps_per_rev) / Fraction(train.periods_per_rev)).numerator
    left_out = (steps - ramp.up.size - ramp.down.size - slew_steps) // whole_periods * whole_periods
    if left_out <= 0:
        return design
    fewer = int(math.copysign(steps - left_out, design.move.steps))
    return design.model_copy(update={"move": design.move.model_copy(update={"steps": fewer})})
