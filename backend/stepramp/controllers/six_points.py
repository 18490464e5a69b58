"""The steps of a move that a ramp of six points gives: of constant acceleration from each point to the next.

Within one, the speed after a way s is √(v₀² + 2 a s), and the way takes the change of speed over the acceleration.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

AT_ONCE = 1_000_000
"""So many steps are worked out at a time: what that needs besides them doesn't grow with the move."""


@dataclass(frozen=True)
class SixPoints:
    """A ramp of six points [steps/s, steps/s²]; its accelerations are above 0, but a1 and d1 where v1 is 0."""

    vstart: float
    a1: float
    v1: float
    amax: float
    vmax: float
    dmax: float
    d1: float
    vstop: float

    def intervals_s(self, steps: int) -> NDArray[np.float64]:
        """Return the wait after each step of a move [s], shape (steps,), steps at least 1."""
        peak = self._peak(steps)
        up = _parts(self.vstart, peak, self.v1, self.a1, self.amax)
        down = _parts(self.vstop, peak, self.v1, self.d1, self.dmax)
        waits = np.empty(steps)
        for first in range(0, steps, AT_ONCE):
            place = np.arange(first, min(first + AT_ONCE, steps) + 1, dtype=np.float64)
            # Counted from either end, so that each ramp is as exact where it is slow.
            rising, falling = _instants(up, place), _instants(down, steps - place)
            level = np.clip(place - _way(up), 0.0, max(0.0, steps - _way(up) - _way(down))) / peak
            waits[first : first + AT_ONCE] = np.diff(rising) + np.diff(level) - np.diff(falling)
        return waits

    def _peak(self, steps: int) -> float:
        """Return the highest speed of a move [steps/s]: where both ramps meet, if that is below VMAX."""
        low, high = max(self.vstart, self.vstop), self.vmax
        if high <= low or self._way_to(high) <= steps:
            return high
        if self._way_to(low) >= steps:
            # So short that one of the ramps alone takes it.
            return low
        corner = min(max(self.v1, low), high)
        if self._way_to(corner) <= steps:
            low = corner
        else:
            high = corner
        # Between corners the way is linear in the square of the speed.
        share = (steps - self._way_to(low)) / (self._way_to(high) - self._way_to(low))
        return math.sqrt(low**2 + share * (high**2 - low**2))

    def _way_to(self, speed: float) -> float:
        up = _parts(self.vstart, speed, self.v1, self.a1, self.amax)
        return _way(up) + _way(_parts(self.vstop, speed, self.v1, self.d1, self.dmax))


_Part = tuple[float, float, float]
"""Of a ramp: from a speed to a speed [steps/s] at an acceleration [steps/s²]."""


def _parts(slow: float, fast: float, corner: float, first: float, second: float) -> list[_Part]:
    """Return the parts of one side of a ramp, from its slow end."""
    bend = min(max(corner, slow), fast)
    parts = [(slow, bend, first)] if bend > slow else []
    return [*parts, (bend, fast, second)] if fast > bend else parts


def _way(parts: list[_Part]) -> float:
    return sum((fast**2 - slow**2) / (2 * rate) for slow, fast, rate in parts)


def _instants(parts: list[_Part], way: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how long each way from the slow end takes [s], as long as the speed changes."""
    instants = np.zeros_like(way)
    done = 0.0
    for slow, fast, rate in parts:
        length = (fast**2 - slow**2) / (2 * rate)
        within = np.clip(way - done, 0.0, length)
        instants += 2 * within / (slow + np.sqrt(slow**2 + 2 * rate * within) + (within == 0.0))
        done += length
    return instants
