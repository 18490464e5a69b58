"""A ramp: two lists of intervals and the interval between them. Both lists begin at the slow end."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class RealRamp:
    """A ramp's intervals as its method computes them, not rounded: ticks, or the unit of a table."""

    up: NDArray[np.floating]
    """Intervals of the acceleration, first interval of a move first, shape (steps,)."""
    slew: float
    """Interval at full speed."""
    down: NDArray[np.floating]
    """Intervals of the deceleration, last interval of a move first, shape (steps,)."""


@dataclass(frozen=True)
class Ramp:
    """The same in whole ticks: what a controller plays."""

    up: NDArray[np.int64]
    slew: int
    down: NDArray[np.int64]
