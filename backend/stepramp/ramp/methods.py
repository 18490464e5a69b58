"""The methods by name: how each computes the two sides of a ramp, in which arithmetic."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Arithmetic, Method, MethodName
from stepramp.errors import Rejected, Rejection
from stepramp.ramp import kinematics, recurrences, tuning
from stepramp.ramp.fixed_point import (
    FixedIntervals,
    fixed_newton_down,
    fixed_newton_up,
    fixed_taylor_down,
    fixed_taylor_up,
)
from stepramp.ramp.kinematics import Number, Slope

NUMBERS: dict[Arithmetic, Number] = {"float64": np.float64, "float32": np.float32}

Side = Callable[[Slope], NDArray[np.floating]]
SideInNumbers = Callable[[Slope, Number], NDArray[np.floating]]


@dataclass(frozen=True)
class Sides:
    """The two sides of a ramp by one method in one arithmetic, each from the slow end [ticks]."""

    up: Side
    down: Side


@dataclass(frozen=True)
class SidesInNumbers:
    """The same for a method that computes in floating-point numbers of a given type."""

    up: SideInNumbers
    down: SideInNumbers


def _mirrored(side: SideInNumbers) -> SidesInNumbers:
    """Return a method that decelerates as it accelerates, backwards."""
    return SidesInNumbers(up=side, down=side)


def _taylor(coefficient: float) -> SidesInNumbers:
    return SidesInNumbers(
        up=lambda slope, number: recurrences.taylor_up(slope, coefficient, number),
        down=lambda slope, number: recurrences.taylor_down(slope, coefficient, number),
    )


COEFFICIENTS: dict[MethodName, float] = {
    "first_order": recurrences.FIRST_ORDER,
    "second_order": recurrences.SECOND_ORDER,
    "compromise": recurrences.COMPROMISE,
}
"""c of p (1 + q + c q²)."""

IN_NUMBERS: dict[MethodName, SidesInNumbers] = {
    "exact": _mirrored(kinematics.exact_intervals),
    "ideal": _mirrored(kinematics.ideal_intervals),
    "midpoint": _mirrored(kinematics.midpoint_intervals),
    **{name: _taylor(coefficient) for name, coefficient in COEFFICIENTS.items()},
    "newton": SidesInNumbers(up=recurrences.newton_up, down=recurrences.newton_down),
    "austin": SidesInNumbers(up=recurrences.austin_up, down=recurrences.austin_down),
}


def sides_of(method: Method) -> Sides:
    """Return the two sides of a method that computes its ramp; a lookup table doesn't.

    They raise Rejected for a slope that the method's arithmetic can't compute.
    """
    if method.arithmetic == "fixed":
        return _fixed_sides(method)
    number = NUMBERS[method.arithmetic]
    if method.name == "tuned":
        return Sides(
            up=lambda slope: tuning.tuned_up(slope, method.tuned_for, number),
            down=lambda slope: tuning.tuned_down(slope, method.tuned_for, number),
        )
    sides = IN_NUMBERS[method.name]
    return Sides(up=lambda slope: sides.up(slope, number), down=lambda slope: sides.down(slope, number))


def _fixed_sides(method: Method) -> Sides:
    if method.name == "newton":
        return Sides(up=_ticks_of(fixed_newton_up), down=_ticks_of(fixed_newton_down))
    if method.name == "tuned":
        return Sides(
            up=_ticks_of(lambda slope: fixed_taylor_up(slope, tuning.coefficient_up(slope, method.tuned_for))),
            down=_ticks_of(lambda slope: fixed_taylor_down(slope, tuning.coefficient_down(slope, method.tuned_for))),
        )
    coefficient = COEFFICIENTS[method.name]
    return Sides(
        up=_ticks_of(partial(fixed_taylor_up, coefficient=coefficient)),
        down=_ticks_of(partial(fixed_taylor_down, coefficient=coefficient)),
    )


def _ticks_of(side: Callable[[Slope], FixedIntervals]) -> Side:
    def ticks(slope: Slope) -> NDArray[np.floating]:
        if slope.steps < 1:
            return np.empty(0)
        try:
            return side(slope).ticks
        except ValueError as error:
            allowed = f"float64 for this ramp. {error}".removesuffix(".")
            raise Rejected([Rejection("method.arithmetic", "fixed", allowed)]) from None

    return ticks
