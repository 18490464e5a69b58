"""exact: the speed at the end of each step, formula (9)."""

import numpy as np
from numpy.typing import NDArray

from stepramp.methods.common.method import CLOSED_FORM, RampMethod, Style, mirrored
from stepramp.numerics.numbers import Number
from stepramp.numerics.slope import Slope


def exact_intervals(slope: Slope, number: Number) -> NDArray[np.floating]:
    """Return the intervals at the speed that each step has at its end [ticks], shape (slope.steps,), slowest first.

    With constant acceleration p_i = F / sqrt(v0² + 2 a i): what the recurrence (9) comes to, by (5) and (7), without
    its rounding errors. Computed in numbers of the given type, in this order of operations.
    """
    return slope.intervals(1, slope.steps, number)


METHOD = RampMethod(
    rank=10,
    label="Exact",
    formula="9",
    summary="formula (9)",
    help="Every interval from the square root: the reference that the others are held against. Dear on a small chip.",
    style=Style("#14181d", "#f2f5f8", file_width=1.8),
    arithmetics=CLOSED_FORM,
    sides=mirrored(exact_intervals),
    is_shown_at_first=True,
)
