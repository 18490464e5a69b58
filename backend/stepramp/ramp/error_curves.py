"""How far the intervals of a profile lie from those of a reference."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Design, MethodName
from stepramp.ramp.move import play
from stepramp.ramp.profile import Profile, profile_of, real_ramp


@dataclass(frozen=True)
class Extreme:
    """The value of a curve that is furthest from 0, and the first step that has it, counted from 1."""

    value: float
    step: int


@dataclass(frozen=True)
class ErrorCurve:
    """The errors of one method's intervals, as they are in whole ticks, against a reference that is not rounded."""

    method: MethodName
    profile: Profile
    """The method's own profile of the move."""
    relative_error: NDArray[np.float64]
    """p_i / reference_i - 1, shape (N,): 0.01 is an interval 1 % too long."""
    tick_error: NDArray[np.float64]
    """p_i - reference_i [ticks], shape (N,)."""

    @property
    def largest_relative_error(self) -> Extreme:
        """The relative error furthest from 0."""
        return _extreme(self.relative_error)

    @property
    def largest_tick_error(self) -> Extreme:
        """The tick error furthest from 0 [ticks]."""
        return _extreme(self.tick_error)


def error_curve(design: Design, method: MethodName, reference: MethodName) -> ErrorCurve:
    """Return the errors of the design's move by one method against another, step by step.

    Raises Rejected when the design does not fit one of them.
    """
    profile = profile_of(design.with_method(method))
    intervals = profile.intervals_ticks
    true = play(real_ramp(design.with_method(reference, "float64")), abs(design.move.steps)).astype(np.float64)
    return ErrorCurve(method, profile, relative_error=intervals / true - 1, tick_error=intervals - true)


def _extreme(curve: NDArray[np.float64]) -> Extreme:
    at = int(np.abs(curve).argmax())
    return Extreme(value=float(curve[at]), step=at + 1)
