"""Acceleration and jerk of a move as planned: what its intervals ask of a motor before they are rounded to ticks."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.numerics.compiled import compiled

Curve = NDArray[np.float64]


@dataclass(frozen=True)
class Motion:
    """One value a step, each of shape (N,)."""

    acceleration_steps_per_s2: Curve
    """(v_i² - v_(i-1)²) / 2, by (6): along step i, the first from the base speed [steps/s²]."""
    jerk_steps_per_s3: Curve
    """(a_(i+1) - a_i) v_i: between the middles of two steps; the last one leads to the base speed [steps/s³]."""


def motion_of(intervals_ticks: Curve, timer_hz: float, base_speed_steps_per_s: float) -> Motion:
    """Return acceleration and jerk of a move with such intervals, not rounded [ticks], shape (N,)."""
    motion = Motion(np.empty(intervals_ticks.size), np.empty(intervals_ticks.size))
    _differences(
        intervals_ticks, timer_hz, base_speed_steps_per_s, motion.acceleration_steps_per_s2, motion.jerk_steps_per_s3
    )
    return motion


@compiled
def _differences(intervals, timer_hz, base_speed, accelerations, jerks):  # type: ignore[no-untyped-def]  # compiled
    # In one pass: over millions of steps it is memory that takes the time.
    count = intervals.size
    base = before = base_speed * base_speed
    speed_before = acceleration_before = 0.0
    for i in range(count + 1):
        speed = timer_hz / intervals[i] if i < count else 0.0
        square = speed * speed if i < count else base
        acceleration = (square - before) / 2.0
        if i:
            jerks[i - 1] = (acceleration - acceleration_before) * speed_before
        if i < count:
            accelerations[i] = acceleration
        before, speed_before, acceleration_before = square, speed, acceleration
