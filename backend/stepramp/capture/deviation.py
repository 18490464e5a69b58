"""Deviation: how far measured steps are from those of a design's planned move."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepramp.capture.matching import EXTRA, match
from stepramp.numerics.compiled import compiled
from stepramp.units import MICROSECONDS_PER_SECOND

FEWEST_FOR_CLOCK = 3
"""Through the deviations of two steps there is always a straight line."""
MOST_LEFT = 0.5
"""What the line may leave, as a part of the mean interval: beyond it a step is nearer to another one's place."""

Alignment = Literal["first_step", "best_fit"]


@dataclass(frozen=True)
class Figures:
    """The deviations of the matched steps, in a few figures."""

    largest_us: float
    """The one that is farthest from zero, without its sign [µs]."""
    largest_at_step: int
    """Which measured step that is of, counted from 0."""
    mean_us: float
    rms_us: float
    clock_ppm: float | None
    """By how much the controller's clock seems slow, from the straight line through the deviations; None where it is no
    clock that they come of [1e-6]."""
    no_clock: str
    """Why that is so, as a sentence; empty where there is a clock."""


@dataclass(frozen=True)
class Deviation:
    """Measured steps laid over planned ones. Arrays of shape (measured steps,), unless it says otherwise."""

    planned_s: NDArray[np.float64]
    """Instants of the planned steps [s], shape (planned steps,)."""
    shift_s: float
    """What is added to measured instants to lay them over the planned ones [s]."""
    planned_step: NDArray[np.int64]
    """Which planned step each one is, counted from 0, or EXTRA."""
    deviation_us: NDArray[np.float64]
    """How much later than planned each one is; NaN for one that is EXTRA [µs]."""
    missing: NDArray[np.int64]
    """Planned steps that were not made, counted from 0, shape (missing,)."""
    extra: NDArray[np.int64]
    """Measured steps that were not planned, counted from 0, shape (extra,)."""
    figures: Figures


def deviation_of(measured_s: NDArray[np.float64], planned_s: NDArray[np.float64], alignment: Alignment) -> Deviation:
    """Return how far measured steps are from planned ones.

    first_step: the first measured step is taken for the first planned one, and for punctual. best_fit: as a whole they
    are shifted so that the sum of the squares of the deviations is least.

    measured_s, planned_s: instants [s], at least one of each.
    """
    planned_step = match(measured_s, planned_s, alignment == "first_step")
    late_s = np.full(measured_s.size, np.nan)
    is_made = np.zeros(planned_s.size, np.bool_)
    count, mean_s = _find_late(measured_s, planned_s, planned_step, late_s, is_made)
    shift_s = float(planned_s[0] - measured_s[0]) if alignment == "first_step" else -mean_s
    late_us = (late_s + shift_s) * MICROSECONDS_PER_SECOND
    largest, mean, rms, ppm, left_us = _figures(late_us, measured_s, count)
    no_clock = _no_clock(planned_s[planned_step[planned_step != EXTRA]], measured_s.size, left_us)
    return Deviation(
        planned_s=planned_s,
        shift_s=shift_s,
        planned_step=planned_step,
        deviation_us=late_us,
        missing=np.flatnonzero(~is_made),
        extra=np.flatnonzero(planned_step == EXTRA),
        figures=Figures(abs(float(late_us[largest])), int(largest), mean, rms, None if no_clock else ppm, no_clock),
    )


def _no_clock(matched_s: NDArray[np.float64], measured: int, left_us: float) -> str:
    """Return why deviations don't come of a clock; empty when they may.

    matched_s: instants of the planned steps that were made [s]. measured: steps.
    left_us: r.m.s. of what a straight line leaves of the deviations [µs].
    """
    if matched_s.size < FEWEST_FOR_CLOCK:
        return f"Of fewer than {FEWEST_FOR_CLOCK} steps that were planned no clock can be told."
    if 2 * matched_s.size < measured:
        return "Most of the steps were not planned: the move is another one."
    interval_us = MICROSECONDS_PER_SECOND * (matched_s[-1] - matched_s[0]) / (matched_s.size - 1)
    if left_us > MOST_LEFT * interval_us:
        return "The steps are not where a slow or a fast clock would have them: the ramp or its waits are others."
    return ""


@compiled
def _find_late(measured, planned, planned_step, late, is_made):  # type: ignore[no-untyped-def]  # compiled
    """Find how late matched steps are, and which planned ones were made; return how many, and their mean."""
    count, total = 0, 0.0
    for j in range(measured.size):
        i = planned_step[j]
        if i >= 0:
            late[j] = measured[j] - planned[i]
            is_made[i] = True
            total += late[j]
            count += 1
    return count, total / count


@compiled
def _figures(late, instants, count):  # type: ignore[no-untyped-def]  # compiled
    """Return where the largest is, mean and root mean square, the slope over time [1e-6], the r.m.s. that it leaves."""
    largest, total, squares, time = -1, 0.0, 0.0, 0.0
    for j in range(late.size):
        if not np.isnan(late[j]):
            if largest < 0 or abs(late[j]) > abs(late[largest]):
                largest = j
            total += late[j]
            squares += late[j] * late[j]
            time += instants[j]
    mean, middle = total / count, time / count
    above, below = 0.0, 0.0
    for j in range(late.size):
        if not np.isnan(late[j]):
            above += (instants[j] - middle) * (late[j] - mean)
            below += (instants[j] - middle) ** 2
    slope = above / below if below > 0 else 0.0
    left = 0.0
    for j in range(late.size):
        if not np.isnan(late[j]):
            left += (late[j] - mean - slope * (instants[j] - middle)) ** 2
    return largest, mean, np.sqrt(squares / count), slope, np.sqrt(left / count)
