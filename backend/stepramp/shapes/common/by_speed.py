"""An acceleration that is any function of the speed: the speeds over position, and the times, that come of it.

With a(v): s = ∫ v dv / a, t = ∫ dv / a. Over x = sqrt(s + s0), s0 = v0² / (2 a(v0)), the speed is smooth even at rest,
and a straight line where a is constant: v = sqrt(2 a) x. So it is computed at many speeds, by Gauss and Legendre's
quadrature, and cubic in between with the slopes dv/dx = 2 x a / v: docs/shapes.md.
"""

import math
from abc import abstractmethod
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stepramp.numerics.compiled import compiled
from stepramp.numerics.numbers import Number
from stepramp.numerics.remembered import remembered
from stepramp.numerics.slope import Slope

CELLS = 4096
"""Parts of a slope between which speeds are computed, shared among the pieces between its kinks …"""
LEAST_CELLS = 128
"""… of which each has so many at least."""
SLOWEST = 1e-9
"""Kinks at less than this part of the slew speed are none."""
NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)


class Cells(NamedTuple):
    """A slope at the ends of its cells, all of shape (cells + 1,)."""

    x: NDArray[np.floating]
    """sqrt(s + s0), increasing."""
    speeds: NDArray[np.floating]
    slopes: NDArray[np.floating]
    """dv/dx."""


@dataclass(frozen=True)
class BySpeed(Slope):
    """One side of a ramp whose acceleration is a function of the speed."""

    @abstractmethod
    def accelerations(self, speeds: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the acceleration at each speed, above 0 [steps/s²], shape of speeds."""

    @property
    @abstractmethod
    def kinks(self) -> NDArray[np.float64]:
        """The speeds at which the function isn't smooth [steps/s], increasing; some may lie beyond the slope."""

    @property
    def length(self) -> float:
        """S = ∫ v dv / a from the base to the slew speed [steps, not whole]."""
        return float(self._places[-1])

    def acceleration_over(self, steps: float) -> float:
        """Return a S / steps: twice as steep is half as long [steps/s²]."""
        return self.acceleration * self.length / steps

    @remembered
    def speeds(self, first: float, count: int, number: Number) -> NDArray[np.floating]:
        """Return the speeds at `first`, `first` + 1 … steps from the base speed [steps/s], shape (count,)."""
        out = np.empty(count, number)
        _speeds(number(first), number(self._offset), number(1), self._cells(number), out)
        return out

    @remembered
    def durations(self, number: Number) -> NDArray[np.floating]:
        """Return F (t(i) - t(i - 1)) = F ∫ 2 x dx / v [ticks], shape (steps,)."""
        out = np.empty(self.steps, number)
        rule = tuple((number((1 + node) / 2), number(weight / 2)) for node, weight in zip(NODES, WEIGHTS, strict=True))
        _durations(number(self.timer_hz), number(self._offset), number(1), self._cells(number), rule, out)
        return out

    @cached_property
    def _at(self) -> NDArray[np.float64]:
        """The speeds at the ends of the cells [steps/s]."""
        # What happens still slower takes no part of a step.
        slowest = max(self.base_speed, SLOWEST * self.slew_speed)
        within = self.kinks[(self.kinks > slowest) & (self.kinks < self.slew_speed)]
        ends = np.concatenate(([self.base_speed], within, [self.slew_speed]))
        count = max(LEAST_CELLS, CELLS // (ends.size - 1)) // 2
        even = [np.linspace(low, high, count) for low, high in pairwise(ends)]
        # Behind the first piece v(x) bends more the slower it is.
        growing = [np.geomspace(low, high, count) for low, high in pairwise(ends[1:])]
        return np.unique(np.clip(np.concatenate((*even, *growing)), self.base_speed, self.slew_speed))

    @cached_property
    def _places(self) -> NDArray[np.float64]:
        """The places of those speeds, from that of the base speed on [steps]."""
        half = np.diff(self._at) / 2
        speeds = self._at[:-1, None] + half[:, None] * (1 + NODES)
        parts = half * ((speeds / self.accelerations(speeds)) @ WEIGHTS)
        return np.concatenate(([0.0], np.cumsum(parts)))

    @property
    def _offset(self) -> float:
        """s0 [steps]."""
        return float(self.base_speed**2 / (2 * self.accelerations(np.array([self.base_speed]))[0]))

    @cached_property
    def _precise_cells(self) -> Cells:
        x, accelerations = np.sqrt(self._places + self._offset), self.accelerations(self._at)
        slopes = np.full(x.size, math.sqrt(2 * accelerations[0]))
        np.divide(2 * x * accelerations, self._at, out=slopes, where=self._at > 0)
        return Cells(x, self._at, slopes)

    def _cells(self, number: Number) -> Cells:
        precise = self._precise_cells
        x: NDArray[np.floating] = precise.x.astype(number)
        # Cells so narrow that their ends are one number are none.
        wide = np.insert(np.diff(x) > 0, 0, True)
        return Cells(x[wide], precise.speeds[wide].astype(number), precise.slopes[wide].astype(number))


@compiled
def _speeds(place, offset, one, cells, out):  # type: ignore[no-untyped-def]  # compiled
    cell = 0
    for i in range(out.size):
        x = np.sqrt(place + offset)
        cell = _cell_of(cells, x, cell)
        out[i] = _speed(cells, x, cell, one)
        place = place + one


@compiled
def _durations(timer_hz, offset, one, cells, rule, out):  # type: ignore[no-untyped-def]  # compiled
    place, cell = offset, 0
    x = np.sqrt(place)
    for i in range(out.size):
        duration = place - place
        place_before, place = place, offset + one * (i + 1)
        end = np.sqrt(place)
        # A step may lead through many cells, or lie in one; its length has more digits than its ends' difference.
        while cell + 2 < cells.x.size and cells.x[cell + 1] < end:
            duration += _time(cells, x, cells.x[cell + 1] - x, cell, rule, one)
            x, cell = cells.x[cell + 1], cell + 1
            place_before = -one
        across = end - x if place_before < 0 else one / (end + x)
        duration += _time(cells, x, across, cell, rule, one)
        x = end
        out[i] = timer_hz * duration


@compiled
def _time(cells, x, across, cell, rule, one):  # type: ignore[no-untyped-def]  # compiled
    """Return the time from x on, within one cell."""
    total = one - one
    for node, weight in rule:
        at = x + node * across
        total += weight * at / _speed(cells, at, cell, one)
    return (total + total) * across


@compiled
def _cell_of(cells, x, cell):  # type: ignore[no-untyped-def]  # compiled
    while cell + 2 < cells.x.size and cells.x[cell + 1] < x:
        cell += 1
    return cell


@compiled
def _speed(cells, x, cell, one):  # type: ignore[no-untyped-def]  # compiled
    """Return the speed at x in its cell: cubic between the speeds and slopes at its ends, straight along the chord."""
    width = cells.x[cell + 1] - cells.x[cell]
    part = (x - cells.x[cell]) / width
    rest = one - part
    chord = cells.speeds[cell + 1] - cells.speeds[cell]
    begins, ends = width * cells.slopes[cell] - chord, width * cells.slopes[cell + 1] - chord
    return cells.speeds[cell] + part * (chord + rest * (rest * begins - part * ends))
