"""Playback of a ramp that is stored as lists of intervals. A move from rest is that of `ramp.move.split`."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from stepramp.numerics.ramp import Ramp
from stepramp.ramp.playback.trajectory import PulseTrain, RampPosition, Ticks, Trajectory

NO_INTERVAL = 2**32


@dataclass(frozen=True)
class ListPosition:
    """Where between the lists a motor is."""

    interval: int = 0
    """The last one played [ticks]; 0 at rest."""
    shortest: int = NO_INTERVAL
    """Since the speed began to rise [ticks]: the ramp down from here has the longer intervals."""
    up_index: int = 0
    """Of the next interval of the ramp up."""
    down_left: int | None = None
    """Steps of the ramp down that are left, when it has begun."""


class ListPlayback:
    """Playback of two lists of intervals, each from the slow end, and the interval between. See trajectory.Playback."""

    def __init__(self, ramp: Ramp) -> None:
        self._up = ramp.up
        self._down = ramp.down
        self._slew = ramp.slew
        # A list's next interval blocks those behind it, so it is its running minimum that decides.
        self._falling = -np.minimum.accumulate(self._down)

    @property
    def slew_interval(self) -> int:
        """Interval at full speed [ticks]."""
        return self._slew

    @property
    def by_formula(self) -> bool:
        """Whether the controller computes it while it is played."""
        return False

    @property
    def rest(self) -> RampPosition:
        """The position of a motor at rest."""
        return ListPosition()

    def trajectory(self, position: RampPosition, steps: int, level: int | None = None) -> Trajectory:
        """Return what is played from a position on; see trajectory.Playback."""
        assert isinstance(position, ListPosition)
        commanded = None if level == self._slew else level
        if position.down_left is not None:
            return self._from_the_ramp_down(position, steps, commanded)
        if steps < self.steps_to_rest(position):
            return self._downwards(position, self.steps_to_rest(position))
        return self._onward(position, steps, commanded)

    def steps_to_rest(self, position: RampPosition) -> int:
        """Return the steps of the shortest ramp down to rest from a position."""
        assert isinstance(position, ListPosition)
        return self._steps_down(position.shortest) if position.down_left is None else position.down_left

    def steps_from(self, interval: int) -> int:
        """Return the steps of the ramp down to rest from the speed of an interval [ticks]."""
        return self._steps_down(interval)

    def _steps_down(self, shortest: int) -> int:
        """Return how many intervals of the ramp down are longer than one [ticks]."""
        return int(np.searchsorted(self._falling, -shortest, side="left"))

    def _onward(self, position: ListPosition, steps: int, commanded: int | None) -> Trajectory:
        """Return a trajectory from rest, from the ramp up or from a level, whose ramp down fits into the steps."""
        could = self._up[position.up_index : position.up_index + steps]
        if commanded is not None:
            faster = could < commanded
            could = could[: int(np.argmax(faster))] if faster.any() else could
        shortest = np.minimum(np.minimum.accumulate(could), position.shortest)
        needed = np.searchsorted(self._falling, -shortest, side="left")
        up = could[: int(np.count_nonzero(np.arange(1, could.size + 1) + needed <= steps))]
        trajectory, here = _upwards(up, position)
        left = steps - up.size
        if up.size < could.size:
            return trajectory + self._downwards(here, left)
        if commanded is not None and 0 < here.interval < commanded:
            turned = ListPosition(here.interval, here.shortest, here.up_index, self._steps_down(here.shortest))
            return trajectory + self._from_the_ramp_down(turned, left, commanded)
        level = self._slew if commanded is None else commanded
        steps_down = self._down.size if commanded is None else self._steps_down(min(level, here.shortest))
        if left > steps_down:
            here = ListPosition(level, min(here.shortest, level), here.up_index)
            trajectory.append(PulseTrain(np.array([level]), left - steps_down, partial(_stay, here)))
            left = steps_down
        return trajectory + self._downwards(here, left)

    def _from_the_ramp_down(self, position: ListPosition, steps: int, commanded: int | None) -> Trajectory:
        assert position.down_left is not None
        down_left, interval = position.down_left, position.interval
        if steps <= down_left:
            return self._downwards(position, down_left)
        trajectory: Trajectory = []
        if commanded is not None and interval < commanded:
            slower = np.flatnonzero(self._down[:down_left] > commanded)
            kept = int(slower[-1]) + 1 if slower.size else 0
            trajectory = self._downwards(position, down_left, kept)
            steps, interval = steps - (down_left - kept), commanded
        up_index = position.up_index
        while up_index > 0 and self._up[up_index - 1] <= interval:
            up_index -= 1
        return trajectory + self._onward(ListPosition(interval, interval, up_index), steps, commanded)

    def _downwards(self, position: ListPosition, steps: int, kept: int = 0) -> Trajectory:
        """Return the ramp down from a position where it has so many steps, but for those that are kept."""
        down = self._down[kept:steps][::-1]

        def after(pulses: int) -> ListPosition:
            return ListPosition(int(down[pulses - 1]), position.shortest, position.up_index, steps - pulses)

        return [PulseTrain(down, down.size, after)] if down.size else []


def _upwards(up: Ticks, before: ListPosition) -> tuple[Trajectory, ListPosition]:
    """Return a ramp up, and where it leads."""

    def after(pulses: int) -> ListPosition:
        shortest = min(before.shortest, int(up[:pulses].min()))
        return ListPosition(int(up[pulses - 1]), shortest, before.up_index + pulses)

    return ([PulseTrain(up, up.size, after)], after(up.size)) if up.size else ([], before)


def _stay(position: ListPosition, _: int) -> ListPosition:
    return position
