"""Playback of a ramp that the controller computes meanwhile; `ramp.on_chip` is its definition."""

from copy import copy
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stepramp.ramp.on_chip import MotorState, OnChipMotor, OnChipRamp
from stepramp.ramp.playback.trajectory import PulseTrain, RampPosition, Ticks, Trajectory

MOST_STEPS_UP = 2**31


@dataclass(frozen=True)
class FormulaPosition:
    """Where on the ramp a motor is. The motor is not to be moved, only copies of it."""

    interval: int
    """The last one played [ticks]; 0 at rest."""
    motor: OnChipMotor


class FormulaPlayback:
    """Playback of a ramp by formula. See trajectory.Playback."""

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
    def rest(self) -> RampPosition:
        """The position of a motor at rest."""
        return FormulaPosition(0, OnChipMotor(self._ramp))

    def steps_to_rest(self, position: RampPosition) -> int:
        """Return the steps of the shortest ramp down to rest from a position."""
        assert isinstance(position, FormulaPosition)
        return position.motor.steps_down

    def steps_from(self, interval: int) -> int:
        """Return the steps of the ramp down to rest from the speed of an interval [ticks]."""
        return int(np.count_nonzero(self._down > interval))

    @cached_property
    def _down(self) -> Ticks:
        return OnChipMotor(self._ramp).down(self._ramp.down.steps)

    def trajectory(self, position: RampPosition, steps: int, level: int | None = None) -> Trajectory:
        """Return what is played from a position on; see trajectory.Playback."""
        assert isinstance(position, FormulaPosition)
        commanded = self.slew_interval if level is None else level
        here, motor, trajectory, is_level = position, position.motor, Trajectory(), False
        if steps > motor.steps_down:
            if motor.state is not MotorState.REST and 0 < here.interval < commanded:
                trajectory, here, is_level = *self._slowed(here, steps, commanded), True
            else:
                trajectory, here, is_level = self._climbed(here, steps, commanded)
            left = steps - sum(train.count for train in trajectory) - here.motor.steps_down
            if left > 0:
                held = FormulaPosition(commanded if is_level else self._held(here), here.motor)
                trajectory.append(PulseTrain(np.array([held.interval]), left, lambda _: held))
                here = held
        return trajectory + _added(here, here.motor.steps_down, goes_up=False)[0]

    def _climbed(
        self, position: FormulaPosition, steps: int, commanded: int
    ) -> tuple[Trajectory, FormulaPosition, bool]:
        """Return the ramp up that leaves room for the ramp down, where it leads, and whether to the commanded speed."""
        could = copy(position.motor).up(position.motor.fitting(steps, min(steps, MOST_STEPS_UP)))
        faster = np.flatnonzero(could < commanded)
        trajectory, here = _added(position, int(faster[0]) if faster.size else could.size, goes_up=True)
        return trajectory, here, bool(faster.size) or here.motor.slews

    def _slowed(self, position: FormulaPosition, steps: int, commanded: int) -> tuple[Trajectory, FormulaPosition]:
        """Return the ramp down to the commanded speed."""
        down = copy(position.motor).down(min(steps, position.motor.steps_down))
        slower = np.flatnonzero(down > commanded)
        return _added(position, int(slower[0]) if slower.size else down.size, goes_up=False)

    def _held(self, position: FormulaPosition) -> int:
        """Return the interval that is held where there is no room to go up."""
        return self._ramp.creep_interval if position.motor.state is MotorState.REST else position.motor.hold_interval


def _added(position: FormulaPosition, count: int, *, goes_up: bool) -> tuple[Trajectory, FormulaPosition]:
    """Return so many steps up or down from a position, and where they lead."""
    if count < 1:
        return [], position

    def after(pulses: int) -> FormulaPosition:
        motor = copy(position.motor)
        intervals = motor.up(pulses) if goes_up else motor.down(pulses)
        return FormulaPosition(int(intervals[-1]), motor)

    motor = copy(position.motor)
    intervals = motor.up(count) if goes_up else motor.down(count)
    return [PulseTrain(intervals, count, after)], FormulaPosition(int(intervals[-1]), motor)
