"""Drawn: the acceleration over the speed as points, monotone cubic in between.

The slopes at the points are those of Fritsch and Butland, "A method for constructing local monotone piecewise cubic
interpolants" (1984): the curve never leaves the range of the two points beside it. Before the first and behind the last
point it is level.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stepramp.shapes.common.by_speed import BySpeed


@dataclass(frozen=True)
class Drawn(BySpeed):
    """One side of a ramp whose acceleration was drawn."""

    rank = 40
    label = "Drawn"
    summary = "the acceleration is a function of the speed, given as points"
    help = (
        "The acceleration as a curve over the speed, as a motor that is weaker at speed needs it: "
        "points, smooth in between."
    )
    takes = frozenset({"points"})

    @property
    def kinks(self) -> NDArray[np.float64]:
        """The speeds of the points [steps/s]."""
        speeds: NDArray[np.float64] = self._points[0]
        return speeds

    def accelerations(self, speeds: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the acceleration at each speed [steps/s²], shape of speeds."""
        (at, _), pieces = self._points, self._pieces
        within = np.minimum(np.maximum(speeds, at[0]), at[-1])
        start, width, part, rise, first_bend, last_bend = pieces[:, np.searchsorted(at[1:-1], within, side="right")]
        place = (within - start) / width
        left = 1 - place
        drawn: NDArray[np.float64] = part + place * (rise + left * (left * first_bend - place * last_bend))
        drawn *= self.acceleration
        return drawn

    @cached_property
    def _points(self) -> NDArray[np.float64]:
        """Speeds and parts of the acceleration, shape (2, points)."""
        return np.array(self.parameters.points, float).T

    @cached_property
    def _pieces(self) -> NDArray[np.float64]:
        """What there is between two points, shape (6, points - 1).

        Its first speed, how wide it is, the part of the acceleration there, how far that rises, and by how much the
        slope at either end is more than even.
        """
        (at, parts), slopes = self._points, self._slopes
        widths, rises = np.diff(at), np.diff(parts)
        return np.array([at[:-1], widths, parts[:-1], rises, widths * slopes[:-1] - rises, widths * slopes[1:] - rises])

    @cached_property
    def _slopes(self) -> NDArray[np.float64]:
        """What the part gains at each point [1/(steps/s)]."""
        at, parts = self._points
        widths, rises = np.diff(at), np.diff(parts) / np.diff(at)
        if at.size == 2:
            return np.repeat(rises, 2)
        slopes = np.zeros(at.size)
        before, after = rises[:-1], rises[1:]
        is_monotone = before * after > 0
        first, second = 2 * widths[1:] + widths[:-1], widths[1:] + 2 * widths[:-1]
        harmonic = first[is_monotone] / before[is_monotone] + second[is_monotone] / after[is_monotone]
        slopes[1:-1][is_monotone] = 3 * (widths[:-1] + widths[1:])[is_monotone] / harmonic
        slopes[0] = _at_an_end(widths[0], widths[1], rises[0], rises[1])
        slopes[-1] = _at_an_end(widths[-1], widths[-2], rises[-1], rises[-2])
        return slopes


def _at_an_end(width: float, next_width: float, rise: float, next_rise: float) -> float:
    """Return the slope at an end by three points, as far as the curve stays monotone."""
    slope = ((2 * width + next_width) * rise - width * next_rise) / (width + next_width)
    if slope * rise <= 0:
        return 0.0
    return 3 * rise if rise * next_rise <= 0 and abs(slope) > 3 * abs(rise) else slope


SHAPE = Drawn
