"""Constant acceleration: the square of the speed grows evenly over position.

Numbers in brackets are formulas of Eiderman, "Real time stepper motor linear ramping just by addition and
multiplication" (2004).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.numerics.compiled import compiled
from stepramp.numerics.numbers import Number
from stepramp.numerics.slope import Slope


@dataclass(frozen=True)
class ConstantAcceleration(Slope):
    """One side of a ramp at a constant acceleration."""

    rank = 10
    label = "Constant"
    summary = "the acceleration stays the same"
    help = (
        "Speed grows evenly over time. The quickest ramp for a given acceleration, with a jolt at its "
        "begin and its end."
    )

    @property
    def length(self) -> float:
        """S = (v² - v0²) / (2 a), formulas (4) and (16) [steps, not whole]."""
        return (self.slew_speed**2 - self.base_speed**2) / (2 * self.acceleration)

    @property
    def initial_interval(self) -> float:
        """p1 = F / sqrt(v0² + 2 a), formula (17) [ticks]."""
        return self.timer_hz / math.sqrt(self.base_speed**2 + 2 * self.acceleration)

    @property
    def multiplier(self) -> float:
        """R = a / F², formula (19) [1/ticks²]."""
        return self.acceleration / self.timer_hz**2

    def acceleration_over(self, steps: float) -> float:
        """Return (v² - v0²) / (2 S), by (4) [steps/s²]."""
        return (self.slew_speed**2 - self.base_speed**2) / (2 * steps)

    def speeds(self, first: float, count: int, number: Number) -> NDArray[np.floating]:
        """Return sqrt(v0² + 2 a S) for S = first, first + 1 …, by (5) [steps/s], shape (count,)."""
        out = np.empty(count, number)
        _speeds(*self._squares(number), number(first), number(1), out)
        return out

    def intervals(self, first: float, count: int, number: Number) -> NDArray[np.floating]:
        """Return F / sqrt(v0² + 2 a S) for S = first, first + 1 …, by (5) and (7) [ticks], shape (count,)."""
        out = np.empty(count, number)
        _intervals(number(self.timer_hz), *self._squares(number), number(first), number(1), out)
        return out

    def durations(self, number: Number) -> NDArray[np.floating]:
        """Return F (t(i) - t(i - 1)) with t(i) = (sqrt(v0² + 2 a i) - v0) / a [ticks], shape (steps,).

        The difference is taken as 2 F / (v(i) + v(i - 1)), which is the same without losing digits.
        """
        speeds = self.speeds(0, self.steps + 1, number)
        durations: NDArray[np.floating] = number(2) * number(self.timer_hz) / (speeds[1:] + speeds[:-1])
        return durations

    def _squares(self, number: Number) -> tuple[np.floating, np.floating]:
        """Return v0² and 2 a, of which the squares of the speeds are made [steps²/s², steps/s²]."""
        base = number(self.base_speed)
        return base * base, number(2) * number(self.acceleration)


@compiled
def _speeds(base_squared, twice, step, one, out):  # type: ignore[no-untyped-def]  # compiled
    # Counted in the numbers of the result; all steps of a move have exact numbers in float32 too.
    for i in range(out.size):
        out[i] = np.sqrt(base_squared + twice * step)
        step = step + one


@compiled
def _intervals(timer_hz, base_squared, twice, step, one, out):  # type: ignore[no-untyped-def]  # compiled
    # In one pass: a long ramp goes through the memory once.
    for i in range(out.size):
        out[i] = timer_hz / np.sqrt(base_squared + twice * step)
        step = step + one


SHAPE = ConstantAcceleration
