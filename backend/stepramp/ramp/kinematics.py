"""Ramps of constant acceleration in closed form.

Numbers in brackets are formulas of Eiderman, "Real time stepper motor linear ramping just by addition and
multiplication" (2004).
"""

import math

import numpy as np
from numpy.typing import NDArray

Number = type[np.float32] | type[np.float64]
"""The arithmetic that a ramp is computed in."""


def ramp_steps(base_speed: float, slew_speed: float, acceleration: float) -> int:
    """Return the whole steps that an acceleration takes.

    S = (v² - v0²) / (2 a), formulas (4) and (16), rounded down: the step after the last of them runs at slew speed.
    Speeds in [steps/s], the acceleration in [steps/s²].
    """
    return math.floor((slew_speed**2 - base_speed**2) / (2 * acceleration))


def initial_interval(timer_hz: float, base_speed: float, acceleration: float) -> float:
    """Return the first interval of a ramp [ticks]: p1 = F / sqrt(v0² + 2 a), formula (17)."""
    return timer_hz / math.sqrt(base_speed**2 + 2 * acceleration)


def slew_interval(timer_hz: float, slew_speed: float) -> float:
    """Return the interval at slew speed [ticks]: pS = F / v, formula (18)."""
    return timer_hz / slew_speed


def exact_intervals(
    timer_hz: float, base_speed: float, acceleration: float, steps: int, number: Number = np.float64
) -> NDArray[np.floating]:
    """Return the intervals of the first steps of a ramp [ticks], shape (steps,), slowest first.

    p_i = F / sqrt(v0² + 2 a i): what the recurrence (9) comes to, by (5) and (7), without its rounding errors.
    Computed in numbers of the given type, in this order of operations.
    """
    i: NDArray[np.floating] = np.arange(1, steps + 1).astype(number)
    squared = number(base_speed) * number(base_speed) + number(2) * number(acceleration) * i
    intervals: NDArray[np.floating] = number(timer_hz) / np.sqrt(squared)
    return intervals
