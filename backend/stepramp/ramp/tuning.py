"""The c of p (1 + q + c q²) that suits a ramp best."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from stepramp.design import TunedFor
from stepramp.ramp.kinematics import Number, Slope, exact_intervals
from stepramp.ramp.recurrences import taylor_down, taylor_up

Side = Callable[[Slope, float, Number], NDArray[np.floating]]

LEAST_COEFFICIENT, GREATEST_COEFFICIENT = 0.0, 4.0
RESOLUTION = 1e-9
"""How closely the coefficient is found: beyond what float32 can tell apart."""


def tuned_up(slope: Slope, tuned_for: TunedFor, number: Number) -> NDArray[np.floating]:
    """Return the intervals of an acceleration with the best c, as taylor_up [ticks]."""
    return taylor_up(slope, best_coefficient(slope, taylor_up, tuned_for), number)


def tuned_down(slope: Slope, tuned_for: TunedFor, number: Number) -> NDArray[np.floating]:
    """Return the intervals of a deceleration with the best c, as taylor_down [ticks]."""
    return taylor_down(slope, best_coefficient(slope, taylor_down, tuned_for), number)


def best_coefficient(slope: Slope, side: Side, tuned_for: TunedFor) -> float:
    """Return the c, from 0 to 4, with which a side's error against the exact ramp is least.

    Every interval grows with c. So the largest relative error is least where the longest interval is as much too long
    as the shortest is too short, and the time is right where the errors sum to nothing: both are where a function
    that grows with c crosses zero, and it is found by halving.
    """
    exact = exact_intervals(slope, np.float64)
    if exact.size < 2:
        return LEAST_COEFFICIENT

    def too_long(coefficient: float) -> float:
        intervals = side(slope, coefficient, np.float64)
        if tuned_for == "time":
            return float(intervals.sum() - exact.sum())
        error = intervals / exact
        return float(error.max() + error.min() - 2)

    low, high = LEAST_COEFFICIENT, GREATEST_COEFFICIENT
    while high - low > RESOLUTION:
        middle = (low + high) / 2
        low, high = (low, middle) if too_long(middle) > 0 else (middle, high)
    return (low + high) / 2
