"""Ramps of constant acceleration in closed form.

Numbers in brackets are formulas of Eiderman, "Real time stepper motor linear ramping just by addition and
multiplication" (2004). The centre-of-step form is that of "Trapezoidal velocity profile for a stepper motor".
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.ramp.compiled import compiled

Number = type[np.float32] | type[np.float64]
"""The arithmetic that a ramp is computed in."""


@dataclass(frozen=True)
class Slope:
    """One side of a ramp: from the base speed to the slew speed, or back, at a constant acceleration."""

    timer_hz: float
    """F [Hz]."""
    base_speed: float
    """v0 [steps/s]."""
    slew_speed: float
    """v [steps/s]."""
    acceleration: float
    """a, or d on the way down; without sign [steps/s²]."""

    @property
    def length(self) -> float:
        """S = (v² - v0²) / (2 a), formulas (4) and (16) [steps, not whole]."""
        return (self.slew_speed**2 - self.base_speed**2) / (2 * self.acceleration)

    @property
    def steps(self) -> int:
        """Whole steps of the slope: the next one runs at slew speed [steps]."""
        return math.floor(self.length)

    @property
    def initial_interval(self) -> float:
        """p1 = F / sqrt(v0² + 2 a), formula (17) [ticks]."""
        return self.timer_hz / math.sqrt(self.base_speed**2 + 2 * self.acceleration)

    @property
    def slew_interval(self) -> float:
        """PS = F / v, formula (18) [ticks]."""
        return self.timer_hz / self.slew_speed

    @property
    def multiplier(self) -> float:
        """R = a / F², formula (19) [1/ticks²]."""
        return self.acceleration / self.timer_hz**2


def exact_intervals(slope: Slope, number: Number) -> NDArray[np.floating]:
    """Return the intervals of a slope [ticks], shape (slope.steps,), slowest first.

    p_i = F / sqrt(v0² + 2 a i): what the recurrence (9) comes to, by (5) and (7), without its rounding errors.
    Computed in numbers of the given type, in this order of operations.
    """
    return _from_step(slope, 1.0, slope.steps, number)


def midpoint_intervals(slope: Slope, number: Number) -> NDArray[np.floating]:
    """Return the intervals at the speed that each step has at its centre [ticks], shape (steps,), slowest first.

    p_i = F / sqrt(v0² + 2 a (i - 1/2)). The steps are those whose centre lies before the end of the slope: one more
    than slope.steps when its length is half a step or more over.
    """
    return _from_step(slope, 0.5, math.ceil(slope.length - 0.5), number)


def ideal_intervals(slope: Slope, number: Number) -> NDArray[np.floating]:
    """Return the intervals between the true instants of constant acceleration [ticks], shape (slope.steps,).

    p_i = F (t(i) - t(i - 1)) with t(i) = (sqrt(v0² + 2 a i) - v0) / a. The difference is taken as
    2 F / (v(i) + v(i - 1)), which is the same without losing digits.
    """
    base, acceleration = number(slope.base_speed), number(slope.acceleration)
    counted: NDArray[np.floating] = np.arange(slope.steps + 1).astype(number)
    speeds = np.sqrt(base * base + number(2) * acceleration * counted)
    intervals: NDArray[np.floating] = number(2) * number(slope.timer_hz) / (speeds[1:] + speeds[:-1])
    return intervals


def _from_step(slope: Slope, first: float, steps: int, number: Number) -> NDArray[np.floating]:
    """Return F / sqrt(v0² + 2 a S) for S = first, first + 1 …, by (5) and (7) [ticks], shape (steps,)."""
    out = np.empty(steps, number)
    base, twice = number(slope.base_speed), number(2) * number(slope.acceleration)
    _at_speeds(number(slope.timer_hz), base * base, twice, number(first), number(1), out)
    return out


@compiled
def _at_speeds(timer_hz, base_squared, twice, step, one, out):  # type: ignore[no-untyped-def]  # compiled
    # Counted in the numbers of the result; all steps of a move have exact numbers in float32 too.
    for i in range(out.size):
        out[i] = timer_hz / np.sqrt(base_squared + twice * step)
        step = step + one
