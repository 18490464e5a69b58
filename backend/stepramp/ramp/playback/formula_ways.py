"""The ways of a ramp that the controller computes while it plays it; `ramp.on_chip` is their definition."""

from copy import copy
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stepramp.ramp.on_chip import OnChipMotor, OnChipRamp, Phase
from stepramp.ramp.playback.course import Course, Place, Stretch, Ticks

MOST_STEPS_UP = 2**31


@dataclass(frozen=True)
class FormulaPlace:
    """Where on the ramp a motor is. The motor is not to be moved, only copies of it."""

    interval: int
    """The last one played [ticks]; 0 at rest."""
    motor: OnChipMotor


class FormulaWays:
    """The ways of a ramp by formula. See course.Ways."""

    def __init__(self, ramp: OnChipRamp) -> None:
        self._ramp = ramp

    @property
    def slew_interval(self) -> int:
        """Interval at full speed [ticks]."""
        return self._ramp.slew_interval

    @property
    def by_formula(self) -> bool:
        """Whether the controller computes it while it is played."""
        return True

    @property
    def rest(self) -> Place:
        """The place of a motor at rest."""
        return FormulaPlace(0, OnChipMotor(self._ramp))

    def steps_to_rest(self, place: Place) -> int:
        """Return the steps of the shortest way to rest from a place."""
        assert isinstance(place, FormulaPlace)
        return place.motor.steps_down

    def steps_from(self, interval: int) -> int:
        """Return the steps of the way to rest from the speed of an interval [ticks]."""
        return int(np.count_nonzero(self._down > interval))

    @cached_property
    def _down(self) -> Ticks:
        return OnChipMotor(self._ramp).down(self._ramp.down.steps)

    def course(self, place: Place, steps: int, level: int | None = None) -> Course:
        """Return what is played from a place on; see course.Ways."""
        assert isinstance(place, FormulaPlace)
        wanted = self.slew_interval if level is None else level
        here, motor, course, is_level = place, place.motor, Course(), False
        if steps > motor.steps_down:
            if motor.phase is not Phase.REST and 0 < here.interval < wanted:
                course, here, is_level = *self._slowed(here, steps, wanted), True
            else:
                course, here, is_level = self._climbed(here, steps, wanted)
            left = steps - sum(stretch.count for stretch in course) - here.motor.steps_down
            if left > 0:
                held = FormulaPlace(wanted if is_level else self._held(here), here.motor)
                course.append(Stretch(np.array([held.interval]), left, lambda _: held))
                here = held
        return course + _added(here, here.motor.steps_down, goes_up=False)[0]

    def _climbed(self, place: FormulaPlace, steps: int, wanted: int) -> tuple[Course, FormulaPlace, bool]:
        """Return the way up that leaves room for the way down, where it leads, and whether to the speed wanted."""
        could = copy(place.motor).up(place.motor.fitting(steps, min(steps, MOST_STEPS_UP)))
        faster = np.flatnonzero(could < wanted)
        course, here = _added(place, int(faster[0]) if faster.size else could.size, goes_up=True)
        return course, here, bool(faster.size) or here.motor.slews

    def _slowed(self, place: FormulaPlace, steps: int, wanted: int) -> tuple[Course, FormulaPlace]:
        """Return the way down to the speed wanted."""
        down = copy(place.motor).down(min(steps, place.motor.steps_down))
        slower = np.flatnonzero(down > wanted)
        return _added(place, int(slower[0]) if slower.size else down.size, goes_up=False)

    def _held(self, place: FormulaPlace) -> int:
        """Return the interval that is held where there is no room to go up."""
        return self._ramp.creep_interval if place.motor.phase is Phase.REST else place.motor.hold_interval


def _added(place: FormulaPlace, count: int, *, goes_up: bool) -> tuple[Course, FormulaPlace]:
    """Return so many steps up or down from a place, and where they lead."""
    if count < 1:
        return [], place

    def after(pulses: int) -> FormulaPlace:
        motor = copy(place.motor)
        intervals = motor.up(pulses) if goes_up else motor.down(pulses)
        return FormulaPlace(int(intervals[-1]), motor)

    motor = copy(place.motor)
    intervals = motor.up(count) if goes_up else motor.down(count)
    return [Stretch(intervals, count, after)], FormulaPlace(int(intervals[-1]), motor)
