"""Moves: how many steps of a ramp's two ends a move of a given length takes, and the intervals it then has.

A ramp is two lists of intervals and the interval between them. Both lists begin at the slow end: `up[0]` is the first
interval of a move, `down[0]` the last. A move takes the slowest intervals of both lists together, so that a short one
rises and falls along the same ramp and the two sides meet at one speed.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Intervals = NDArray[np.int64] | NDArray[np.float32] | NDArray[np.float64] | NDArray[np.floating]


@dataclass(frozen=True)
class Ramp:
    """A ramp's intervals, all in one unit: ticks, whole or not."""

    up: Intervals
    """Intervals of the acceleration, first interval of a move first, shape (steps,)."""
    slew: float
    """Interval at full speed."""
    down: Intervals
    """Intervals of the deceleration, last interval of a move first, shape (steps,)."""


def split(ramp: Ramp, steps: int) -> tuple[int, int]:
    """Return how many intervals of the ramp's up and down lists a move of so many steps takes.

    The lists grow together from their slow ends: the longer of the two next intervals is taken, that of `up` when
    they are equal, until the move is full or both lists are used up. What is left runs at the slew interval.
    """
    if steps >= ramp.up.size + ramp.down.size:
        return ramp.up.size, ramp.down.size
    # A list's next interval blocks those behind it, so it is its running minimum that decides.
    up = np.minimum.accumulate(ramp.up[:steps])
    down = np.minimum.accumulate(ramp.down[:steps])
    # Intervals of `up` that are taken before `down`'s j-th: those that are at least as long.
    before = np.searchsorted(-up, -down, side="right")
    n_down = int(np.count_nonzero(before + np.arange(down.size) < steps))
    return steps - n_down, n_down


def play(ramp: Ramp, steps: int, sides: tuple[int, int] | None = None) -> Intervals:
    """Return the intervals of a move, in order of time, shape (steps,).

    sides: how many are of the up and of the down list; without it, as `split` says.
    """
    n_up, n_down = sides or split(ramp, steps)
    slew = np.full(steps - n_up - n_down, ramp.slew, ramp.up.dtype)
    return np.concatenate((ramp.up[:n_up], slew, ramp.down[:n_down][::-1]))
