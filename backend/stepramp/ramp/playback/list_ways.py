"""The ways of a ramp that is stored as lists of intervals. A move from rest is that of `ramp.move.split`."""

from dataclasses import dataclass
from functools import partial

import numpy as np

from stepramp.numerics.ramp import Ramp
from stepramp.ramp.playback.course import Course, Place, Stretch, Ticks

NO_INTERVAL = 2**32


@dataclass(frozen=True)
class ListPlace:
    """Where between the lists a motor is."""

    interval: int = 0
    """The last one played [ticks]; 0 at rest."""
    shortest: int = NO_INTERVAL
    """Since the speed began to rise [ticks]: the way down from here has the longer intervals."""
    up_index: int = 0
    """Of the next interval of the way up."""
    down_left: int | None = None
    """Steps of the way down that are left, when it has begun."""


class ListWays:
    """The ways of two lists of intervals, each from the slow end, and the interval between. See course.Ways."""

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
    def rest(self) -> Place:
        """The place of a motor at rest."""
        return ListPlace()

    def course(self, place: Place, steps: int, level: int | None = None) -> Course:
        """Return what is played from a place on; see course.Ways."""
        assert isinstance(place, ListPlace)
        wanted = None if level == self._slew else level
        if place.down_left is not None:
            return self._from_the_way_down(place, steps, wanted)
        if steps < self.steps_to_rest(place):
            return self._downwards(place, self.steps_to_rest(place))
        return self._onward(place, steps, wanted)

    def steps_to_rest(self, place: Place) -> int:
        """Return the steps of the shortest way to rest from a place."""
        assert isinstance(place, ListPlace)
        return self._steps_down(place.shortest) if place.down_left is None else place.down_left

    def steps_from(self, interval: int) -> int:
        """Return the steps of the way to rest from the speed of an interval [ticks]."""
        return self._steps_down(interval)

    def _steps_down(self, shortest: int) -> int:
        """Return how many intervals of the way down are longer than one [ticks]."""
        return int(np.searchsorted(self._falling, -shortest, side="left"))

    def _onward(self, place: ListPlace, steps: int, wanted: int | None) -> Course:
        """Return a course from rest, from the way up or from a level, whose way down fits into the steps."""
        could = self._up[place.up_index : place.up_index + steps]
        if wanted is not None:
            faster = could < wanted
            could = could[: int(np.argmax(faster))] if faster.any() else could
        shortest = np.minimum(np.minimum.accumulate(could), place.shortest)
        needed = np.searchsorted(self._falling, -shortest, side="left")
        up = could[: int(np.count_nonzero(np.arange(1, could.size + 1) + needed <= steps))]
        course, here = _upwards(up, place)
        left = steps - up.size
        if up.size < could.size:
            return course + self._downwards(here, left)
        if wanted is not None and 0 < here.interval < wanted:
            turned = ListPlace(here.interval, here.shortest, here.up_index, self._steps_down(here.shortest))
            return course + self._from_the_way_down(turned, left, wanted)
        level = self._slew if wanted is None else wanted
        steps_down = self._down.size if wanted is None else self._steps_down(min(level, here.shortest))
        if left > steps_down:
            here = ListPlace(level, min(here.shortest, level), here.up_index)
            course.append(Stretch(np.array([level]), left - steps_down, partial(_stay, here)))
            left = steps_down
        return course + self._downwards(here, left)

    def _from_the_way_down(self, place: ListPlace, steps: int, wanted: int | None) -> Course:
        assert place.down_left is not None
        down_left, interval = place.down_left, place.interval
        if steps <= down_left:
            return self._downwards(place, down_left)
        course: Course = []
        if wanted is not None and interval < wanted:
            slower = np.flatnonzero(self._down[:down_left] > wanted)
            kept = int(slower[-1]) + 1 if slower.size else 0
            course = self._downwards(place, down_left, kept)
            steps, interval = steps - (down_left - kept), wanted
        up_index = place.up_index
        while up_index > 0 and self._up[up_index - 1] <= interval:
            up_index -= 1
        return course + self._onward(ListPlace(interval, interval, up_index), steps, wanted)

    def _downwards(self, place: ListPlace, steps: int, kept: int = 0) -> Course:
        """Return the way down from a place where it has so many steps, but for those that are kept."""
        down = self._down[kept:steps][::-1]

        def after(pulses: int) -> ListPlace:
            return ListPlace(int(down[pulses - 1]), place.shortest, place.up_index, steps - pulses)

        return [Stretch(down, down.size, after)] if down.size else []


def _upwards(up: Ticks, before: ListPlace) -> tuple[Course, ListPlace]:
    """Return a way up, and where it leads."""

    def after(pulses: int) -> ListPlace:
        shortest = min(before.shortest, int(up[:pulses].min()))
        return ListPlace(int(up[pulses - 1]), shortest, before.up_index + pulses)

    return ([Stretch(up, up.size, after)], after(up.size)) if up.size else ([], before)


def _stay(place: ListPlace, _: int) -> ListPlace:
    return place
