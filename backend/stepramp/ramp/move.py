"""Moves: how many steps of a ramp's two ends a move of a given length takes, and the intervals it then has.

A ramp is two lists of intervals and the interval between them. Both lists begin at the slow end: `up[0]` is the first
interval of a move, `down[0]` the last. A move takes the slowest intervals of both lists together, so that a short one
rises and falls along the same ramp and the two sides meet at one speed.
"""

from typing import overload

import numpy as np
from numpy.typing import NDArray

from stepramp.numerics.compiled import compiled
from stepramp.numerics.ramp import Ramp, RealRamp


def split(ramp: RealRamp | Ramp, steps: int) -> tuple[int, int]:
    """Return how many intervals of the ramp's up and down lists a move of so many steps takes.

    The lists grow together from their slow ends: the longer of the two next intervals is taken, that of `up` when
    they are equal, until the move is full or both lists are used up. What is left runs at the slew interval.
    """
    if steps >= ramp.up.size + ramp.down.size:
        return ramp.up.size, ramp.down.size
    n_up = int(_taken_of_up(ramp.up, ramp.down, steps))
    return n_up, steps - n_up


@compiled
def _taken_of_up(up, down, steps):  # type: ignore[no-untyped-def]  # compiled
    n_up = n_down = 0
    while n_up + n_down < steps:
        if n_down == down.size or (n_up < up.size and up[n_up] >= down[n_down]):
            n_up += 1
        else:
            n_down += 1
    return n_up


@overload
def play(ramp: RealRamp, steps: int, sides: tuple[int, int] | None = None) -> NDArray[np.floating]: ...
@overload
def play(ramp: Ramp, steps: int, sides: tuple[int, int] | None = None) -> NDArray[np.int64]: ...
def play(
    ramp: RealRamp | Ramp, steps: int, sides: tuple[int, int] | None = None
) -> NDArray[np.floating] | NDArray[np.int64]:
    """Return the intervals of a move, in order of time, shape (steps,).

    sides: how many are of the up and of the down list; without it, as `split` says.
    """
    n_up, n_down = sides or split(ramp, steps)
    slew = np.full(steps - n_up - n_down, ramp.slew, ramp.up.dtype)
    return np.concatenate((ramp.up[:n_up], slew, ramp.down[:n_down][::-1]))
