"""The methods by name: how each computes the two sides of a ramp."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Method, MethodName
from stepramp.ramp import kinematics, recurrences, tuning
from stepramp.ramp.kinematics import Number, Slope

Side = Callable[[Slope, Number], NDArray[np.floating]]


@dataclass(frozen=True)
class Sides:
    """The two sides of a ramp by one method, each from the slow end [ticks]."""

    up: Side
    down: Side


def _mirrored(side: Side) -> Sides:
    """Return a method that decelerates as it accelerates, backwards."""
    return Sides(up=side, down=side)


def _taylor(coefficient: float) -> Sides:
    return Sides(
        up=lambda slope, number: recurrences.taylor_up(slope, coefficient, number),
        down=lambda slope, number: recurrences.taylor_down(slope, coefficient, number),
    )


SIDES: dict[MethodName, Sides] = {
    "exact": _mirrored(kinematics.exact_intervals),
    "ideal": _mirrored(kinematics.ideal_intervals),
    "midpoint": _mirrored(kinematics.midpoint_intervals),
    "first_order": _taylor(recurrences.FIRST_ORDER),
    "second_order": _taylor(recurrences.SECOND_ORDER),
    "compromise": _taylor(recurrences.COMPROMISE),
    "newton": Sides(up=recurrences.newton_up, down=recurrences.newton_down),
    "austin": Sides(up=recurrences.austin_up, down=recurrences.austin_down),
}


def sides_of(method: Method) -> Sides:
    """Return the two sides of a method that computes its ramp; a lookup table doesn't."""
    if method.name == "tuned":
        return Sides(
            up=lambda slope, number: tuning.tuned_up(slope, method.tuned_for, number),
            down=lambda slope, number: tuning.tuned_down(slope, method.tuned_for, number),
        )
    return SIDES[method.name]
