"""tuned: p (1 + q + c q²) with the c that suits a ramp best, one for each side."""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from stepramp.methods.common.method import STEP_BY_STEP, RampMethod, Sides, Style, TunedFor, TuningReport
from stepramp.methods.common.taylor import GREATEST_COEFFICIENT, taylor_down, taylor_sides, taylor_up
from stepramp.methods.compromise import COEFFICIENT as COMPROMISE
from stepramp.methods.exact import exact_intervals
from stepramp.methods.first_order import COEFFICIENT as FIRST_ORDER
from stepramp.methods.second_order import COEFFICIENT as SECOND_ORDER
from stepramp.numerics.numbers import Arithmetic, Number
from stepramp.shapes.constant import ConstantAcceleration

TunedSideIntervals = Callable[[ConstantAcceleration, float, Number], NDArray[np.floating]]

LEAST_COEFFICIENT = 0.0
RESOLUTION = 1e-9
"""How closely the coefficient is found: beyond what float32 can tell apart."""
KEPT_COEFFICIENTS = 64


def tuned_sides(arithmetic: Arithmetic, tuned_for: TunedFor) -> Sides:
    """Return both sides of a ramp, each with its best c."""
    return Sides(
        up=lambda slope: taylor_sides(coefficient_up(slope, tuned_for))(arithmetic, tuned_for).up(slope),
        down=lambda slope: taylor_sides(coefficient_down(slope, tuned_for))(arithmetic, tuned_for).down(slope),
    )


def coefficient_up(slope: ConstantAcceleration, tuned_for: TunedFor) -> float:
    """Return the best c of an acceleration."""
    return best_coefficient(slope, taylor_up, tuned_for)


def coefficient_down(slope: ConstantAcceleration, tuned_for: TunedFor) -> float:
    """Return the best c of a deceleration."""
    return best_coefficient(slope, taylor_down, tuned_for)


def report(up: ConstantAcceleration, down: ConstantAcceleration, tuned_for: TunedFor) -> TuningReport:
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


@lru_cache(KEPT_COEFFICIENTS)
def best_coefficient(slope: ConstantAcceleration, side: TunedSideIntervals, tuned_for: TunedFor) -> float:
    """Return the c, from 0 to 4, with which a side's error against the exact ramp is least.

    Every interval grows with c. So the largest relative error is least where the longest interval is as much too long
    as the shortest is too short, and the time is right where the errors sum to nothing: both are where a function
    that grows with c crosses zero, and it is found by halving. That takes some thirty ramps: what was found for a slope
    is kept for its other arithmetics and requests.
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


METHOD = RampMethod(
    rank=70,
    label="Tuned",
    summary="p (1 + q + c q²) with the c that suits the ramp",
    help="p (1 + q + c q²) with the c that suits this ramp, found anew for each: a constant to the chip.",
    style=Style("#7a7000", "#d9c400", dash=(10, 2, 4, 2), file_dash=(8, 1.5, 3, 1.5)),
    arithmetics=STEP_BY_STEP,
    sides=tuned_sides,
    shape=ConstantAcceleration,
    tuning=report,
)
