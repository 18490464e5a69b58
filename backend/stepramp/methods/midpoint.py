"""midpoint: the speed at the centre of each step, as in "Trapezoidal velocity profile for a stepper motor"."""

import math

import numpy as np
from numpy.typing import NDArray

from stepramp.methods.common.method import CLOSED_FORM, RampMethod, Style, mirrored
from stepramp.numerics.numbers import Number
from stepramp.numerics.slope import Slope


def midpoint_intervals(slope: Slope, number: Number) -> NDArray[np.floating]:
    """Return the intervals at the speed that each step has at its centre [ticks], shape (steps,), slowest first.

    With constant acceleration p_i = F / sqrt(v0² + 2 a (i - 1/2)). The steps are those whose centre lies before the end
    of the slope: one more than slope.steps when its length is half a step or more over.
    """
    return slope.intervals(0.5, math.ceil(slope.length - 0.5), number)


METHOD = RampMethod(
    rank=30,
    label="Midpoint",
    summary="speed at the centre of the step",
    help="Each interval from the speed at the centre of its step. From the second step on it is close to ideal.",
    style=Style("#8a5a2b", "#c8a27a", dash=(5, 3), file_dash=(4, 2)),
    arithmetics=CLOSED_FORM,
    sides=mirrored(midpoint_intervals),
)
