"""The c of p (1 + q + c q²) that suits a ramp best."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.design import TunedFor
from stepramp.ramp.kinematics import Number, Slope, exact_intervals
from stepramp.ramp.recurrences import COMPROMISE, FIRST_ORDER, SECOND_ORDER, taylor_down, taylor_up

Side = Callable[[Slope, float, Number], NDArray[np.floating]]

LEAST_COEFFICIENT, GREATEST_COEFFICIENT = 0.0, 4.0
RESOLUTION = 1e-9
"""How closely the coefficient is found: beyond what float32 can tell apart."""


def tuned_up(slope: Slope, tuned_for: TunedFor, number: Number) -> NDArray[np.floating]:
    """Return the intervals of an acceleration with the best c, as taylor_up [ticks]."""
    return taylor_up(slope, coefficient_up(slope, tuned_for), number)


def tuned_down(slope: Slope, tuned_for: TunedFor, number: Number) -> NDArray[np.floating]:
    """Return the intervals of a deceleration with the best c, as taylor_down [ticks]."""
    return taylor_down(slope, coefficient_down(slope, tuned_for), number)


def coefficient_up(slope: Slope, tuned_for: TunedFor) -> float:
    """Return the best c of an acceleration."""
    return best_coefficient(slope, taylor_up, tuned_for)


def coefficient_down(slope: Slope, tuned_for: TunedFor) -> float:
    """Return the best c of a deceleration."""
    return best_coefficient(slope, taylor_down, tuned_for)


@dataclass(frozen=True)
class TuningReport:
    """What tuning found, and how much better it is than formulas (20), (22) and (23), in float64."""

    coefficient_up: float
    coefficient_down: float
    largest_relative_error: dict[str, float]
    """By method, the largest relative error of an interval of either side, without sign."""
    time_error: dict[str, float]
    """By method, how much longer both sides take together than the exact ones, as a part of their time."""


def report(up: Slope, down: Slope, tuned_for: TunedFor) -> TuningReport:
    """Return what tuning does for the two sides of a ramp."""
    found = (coefficient_up(up, tuned_for), coefficient_down(down, tuned_for))
    tried = {"first_order": (FIRST_ORDER,) * 2, "second_order": (SECOND_ORDER,) * 2, "compromise": (COMPROMISE,) * 2}
    exact = np.concatenate((exact_intervals(up, np.float64), exact_intervals(down, np.float64)))
    largest, time = {}, {}
    for name, (c_up, c_down) in {**tried, "tuned": found}.items():
        sides = (taylor_up(up, c_up, np.float64), taylor_down(down, c_down, np.float64))
        intervals = np.concatenate(sides)
        largest[name] = float(np.abs(intervals / exact - 1).max(initial=0))
        time[name] = float(intervals.sum() / exact.sum() - 1) if exact.size else 0.0
    return TuningReport(*found, largest, time)


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
