"""ideal: the true instants of the ramp."""

import numpy as np
from numpy.typing import NDArray

from stepramp.methods.common.method import CLOSED_FORM, RampMethod, Style, mirrored
from stepramp.numerics.numbers import Number
from stepramp.numerics.slope import Slope


def ideal_intervals(slope: Slope, number: Number) -> NDArray[np.floating]:
    """Return the intervals between the true instants of a ramp's shape [ticks], shape (slope.steps,)."""
    return slope.durations(number)


METHOD = RampMethod(
    rank=20,
    label="Ideal",
    summary="true instants of constant acceleration",
    help="The true instants of constant acceleration. From rest its first interval is twice that of the exact formula.",
    style=Style("#66717f", "#9aa7b5", dash=(2, 3), file_dash=(1, 1.5)),
    arithmetics=CLOSED_FORM,
    sides=mirrored(ideal_intervals),
)
