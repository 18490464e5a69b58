"""Trajectories: what a motor plays of its ramp, from rest or from the midst of a move, until it comes to rest.

A trajectory is decided as the firmware decides it: as many steps of the ramp up as leave room for the ramp down, then
the commanded speed, then the ramp down. So target and speed may change at any step. A target that is too close, or
behind, is passed: the trajectory then ends beyond it.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Ticks = NDArray[np.int64]


class RampPosition(Protocol):
    """Where on its ramp a motor is; what more there is to it only its playback knows."""

    @property
    def interval(self) -> int:
        """The last one played [ticks]; 0 at rest."""


@dataclass(frozen=True)
class PulseTrain:
    """Pulses, an interval after each: the intervals of an array, or `count` times a single one."""

    intervals: Ticks
    count: int
    position_after: Callable[[int], RampPosition]
    """Returns where the motor is once so many pulses have been made, at least one."""

    @cached_property
    def _ends(self) -> Ticks:
        return np.cumsum(self.intervals)

    @property
    def _is_level(self) -> bool:
        return self.intervals.size == 1

    def pulses_within(self, ticks: int) -> int:
        """Return how many pulses come up to so long after the first, itself included [ticks]."""
        if self._is_level:
            return min(self.count, ticks // int(self.intervals[0]) + 1)
        return 1 + int(np.searchsorted(self._ends[:-1], ticks, side="right"))

    def ticks_to(self, pulse: int) -> int:
        """Return the time from the first pulse to another, counted from 0; the count: to the end [ticks]."""
        if self._is_level:
            return pulse * int(self.intervals[0])
        return int(self._ends[pulse - 1]) if pulse else 0

    def instants(self, pulses: NDArray[np.int64]) -> Ticks:
        """Return the times from the first pulse to others, counted from 0 [ticks], shape of pulses."""
        begins: Ticks = pulses * self.intervals[0] if self._is_level else np.append(0, self._ends)[pulses]
        return begins


Trajectory = list[PulseTrain]


class Playback(Protocol):
    """How an axis' ramp is played, from wherever on it the motor is."""

    @property
    def slew_interval(self) -> int:
        """Interval at full speed [ticks]."""

    @property
    def by_formula(self) -> bool:
        """Whether the controller computes it while it is played."""

    @property
    def rest(self) -> RampPosition:
        """The position of a motor at rest."""

    def trajectory(self, position: RampPosition, steps: int, level: int | None = None) -> Trajectory:
        """Return what is played from a position on, to come to rest after so many steps, or later where that can't be.

        level: interval of the commanded speed [ticks]; None: the slew speed.
        """

    def steps_to_rest(self, position: RampPosition) -> int:
        """Return the steps of the shortest ramp down to rest from a position."""

    def steps_from(self, interval: int) -> int:
        """Return the steps of the ramp down to rest from the speed of an interval [ticks]."""


def pulse_instants(trajectory: Sequence[PulseTrain], pulses: NDArray[np.int64]) -> Ticks:
    """Return when pulses of a trajectory come, counted from 1, from the first on [ticks], shape of pulses.

    Pulses beyond the trajectory come when it ends.
    """
    firsts = np.cumsum([0, *(train.count for train in trajectory)])
    begins = np.cumsum([0, *(train.ticks_to(train.count) for train in trajectory)])
    instants = np.full(pulses.shape, begins[-1], np.int64)
    for train, first, begin in zip(trajectory, firsts, begins, strict=False):
        within = (pulses > first) & (pulses <= first + train.count)
        instants[within] = begin + train.instants(pulses[within] - 1 - first)
    return instants
