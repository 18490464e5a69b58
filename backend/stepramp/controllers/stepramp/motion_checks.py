"""What is checked of a motion before it is asked for: axes, ranges, and what the controller's processor can serve."""

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from stepramp.controllers.contract import AxisCommand, values_of
from stepramp.controllers.inputs import End
from stepramp.controllers.speed_ranges import homing_speed_for, too_fast_for, too_slow_for
from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus
from stepramp.controllers.stepramp.messages.session import HelloReply
from stepramp.controllers.stepramp.playback import playback_of
from stepramp.controllers.stepramp.ramp_image import RampImage
from stepramp.controllers.stepramp.settings import MOST_GAUGES, StepRampSettings
from stepramp.controllers.stepramp.speed_limits import Pace, SpeedLimits, interval_ticks
from stepramp.errors import Limits, Refused, Rejected, Rejection
from stepramp.ramp.playback.trajectory import Playback
from stepramp.units import speed_from_interval

FURTHEST_STEPS = 2**31 - 1
TARGETS = "a target from -2,147,483,648 to 2,147,483,647 steps"
TARGET_LIMITS = Limits(-FURTHEST_STEPS - 1, FURTHEST_STEPS, "steps", is_whole=True)

Moving = Callable[[bool], Mapping[int, int]]
"""Returns the axes that move with their present intervals [ticks], 0 between two moves; as last heard or asked anew."""
Rejecting = Callable[[Refusal], Rejection]


class MotionChecks:
    """What is known of the ramps and settings in use, and what it allows."""

    def __init__(self) -> None:
        self.playbacks: list[Playback] = []
        """Of each axis."""
        self.running: dict[int, int] = {}
        """Intervals of the axes that run at a speed, or slow down from it [ticks]."""
        self._limits: SpeedLimits | None = None
        self._image: RampImage | None = None
        self._longest_ticks = 0
        self._timer_hz = 1

    def use(self, image: RampImage | None, hello: HelloReply, settings: StepRampSettings) -> None:
        """Check what is asked against these ramps and settings from now on."""
        if image is not self._image or not self.playbacks:
            self.playbacks = [playback_of(ramp) for ramp in image.axes] if image else []
            self.running = {}
        self._image = image
        self._longest_ticks = hello.longest_interval_ticks
        self._timer_hz = hello.fast_clock_hz if image is not None and image.fast_clock else hello.slow_clock_hz
        self._limits = SpeedLimits.of(hello, settings, self._timer_hz)

    def known_axes(self, commands: Sequence[AxisCommand]) -> None:
        """Reject axes that have no ramp, and one that is named twice; Refused when none has one."""
        if not self.playbacks:
            raise Refused("The controller has no ramp yet: push a design first.")
        axes = [each.axis for each in commands]
        for number, each in enumerate(commands):
            field = _axis_field(each.field)
            if not 0 <= each.axis < len(self.playbacks):
                raise Rejected(
                    [Rejection(field, each.axis, f"an axis that has a ramp: 0 to {len(self.playbacks) - 1}")]
                )
            if each.axis in axes[:number]:
                raise Rejected([Rejection(field, each.axis, "each axis once")])

    def whole_values(self, commands: Sequence[AxisCommand]) -> dict[int, int]:
        """Return what is asked by axes, in ascending order; Rejected when a controller can't be told it."""
        self.known_axes(commands)
        for each in commands:
            if not -FURTHEST_STEPS - 1 <= each.value <= FURTHEST_STEPS:
                raise Rejected([Rejection(each.field, each.value, TARGETS, TARGET_LIMITS)])
        return {axis: int(value) for axis, value in values_of(commands).items()}

    def intervals_of(self, speeds: Sequence[AxisCommand]) -> dict[int, int]:
        """Return the intervals of speeds by axes [ticks]; Rejected when an axis' ramp doesn't lead to one."""
        self.known_axes(speeds)
        for each in speeds:
            if each.value == 0:
                continue
            slew = self.playbacks[each.axis].slew_interval
            slowest, fastest = (speed_from_interval(ticks, self._timer_hz) for ticks in (self._longest_ticks, slew))
            # Of a speed that is slower by far, the interval may be beyond all numbers.
            is_beyond_slow = abs(each.value) * (self._longest_ticks + 1) < self._timer_hz
            if is_beyond_slow or abs(interval_ticks(each.value, self._timer_hz)) > self._longest_ticks:
                raise Rejected([too_slow_for(each, slowest, fastest)])
            if abs(interval_ticks(each.value, self._timer_hz)) < slew:
                raise Rejected([too_fast_for(each, slowest, fastest, "the slew speed of the axis' ramp")])
        return {axis: interval_ticks(speed, self._timer_hz) for axis, speed in values_of(speeds).items()}

    def homing_intervals(self, fast: Sequence[AxisCommand]) -> dict[int, int]:
        """Return the intervals of axes that are homed [ticks]; Rejected for a speed that their ramps don't lead to."""
        self.known_axes(fast)
        return {each.axis: self._homing_interval(each, " either way: the sign is the switch's end") for each in fast}

    def slow_interval(self, slow: AxisCommand, axes: Iterable[int]) -> int:
        """Return the interval of one speed of several axes [ticks]; Rejected when a ramp of theirs is too slow."""
        (interval,) = {self._homing_interval(replace(slow, axis=axis), ", without a sign") for axis in axes}
        return interval

    def _homing_interval(self, asked: AxisCommand, note: str) -> int:
        try:
            interval = self.intervals_of([asked])[asked.axis]
        except Rejected:
            interval = 0
        if not interval:
            slew = self.playbacks[asked.axis].slew_interval
            slowest, fastest = (speed_from_interval(ticks, self._timer_hz) for ticks in (self._longest_ticks, slew))
            raise Rejected([homing_speed_for(asked, slowest, fastest, note)])
        return interval

    def unless_not_to_home(
        self, moving: Moving, fast: Sequence[AxisCommand], intervals: Mapping[int, int]
    ) -> Rejecting:
        """Reject axes that have no limit switch where they are sent; returns as unless_too_fast does."""
        limits = {(role.axis, role.end) for role in self._limits_in_use.settings.inputs or ()}
        astray = [each for each in fast if (each.axis, _end_of(each)) not in limits]
        if astray:
            raise Rejected([_no_switch(each) for each in astray])
        rejecting = self.unless_too_fast(moving, fast, intervals)

        def rejection(refusal: Refusal) -> Rejection:
            if refusal.status is ReplyStatus.TOO_FAST:
                return rejecting(refusal)
            return _no_switch(next((each for each in fast if each.axis == refusal.detail), fast[0]))

        return rejection

    def run_no_more(self, axes: Iterable[int]) -> None:
        """Note that axes are at rest, or on their way to a target."""
        for axis in axes:
            self.running.pop(axis, None)

    def slew_intervals(self, axes: Collection[int]) -> dict[int, int]:
        """Return the shortest intervals of axes' ramps [ticks]."""
        return {axis: self.playbacks[axis].slew_interval for axis in axes}

    def unless_too_fast(
        self, moving: Moving, commands: Sequence[AxisCommand], intervals: Mapping[int, int]
    ) -> Rejecting:
        """Reject axes that can't be served with these intervals [ticks] next to those that move.

        Returns what is to be rejected when the controller finds something wrong itself.
        """
        self._with_pins(commands)
        going = self._going(moving(False), intervals)
        if self._limits_in_use.share(self._paces(going)) > 1:
            going = self._going(moving(True), intervals)
        share = self._limits_in_use.share(self._paces(going))
        if share > 1:
            raise Rejected([self._too_fast(commands, going, share)])
        return _rejecting(commands, lambda share: self._too_fast(commands, going, share))

    def _going(self, moving: Mapping[int, int], intervals: Mapping[int, int]) -> dict[int, int]:
        """Return the shortest intervals of all axes that will move: of those that slow down the present one [ticks]."""
        going = {axis: abs(interval) for axis, interval in intervals.items() if interval}
        for axis, present in moving.items():
            told = going.get(axis) or self.running.get(axis, self.playbacks[axis].slew_interval)
            going[axis] = min(told, present or told)
        return going

    def ramp_axis(self, steps: Mapping[int, int], ramp_axis: int | None) -> int:
        """Return whose ramp a line plays: without a choice that of the slowest axis that goes along."""
        if ramp_axis is None:
            going = [axis for axis, count in steps.items() if count] or list(steps)
            return max(going, key=lambda axis: self.playbacks[axis].slew_interval)
        if not 0 <= ramp_axis < len(self.playbacks):
            allowed = f"an axis that has a ramp: 0 to {len(self.playbacks) - 1}"
            raise Rejected([Rejection("ramp_axis", ramp_axis, allowed)])
        return ramp_axis

    def unless_line_too_fast(
        self, commands: Sequence[AxisCommand], steps: Mapping[int, int], ramp_axis: int
    ) -> Rejecting:
        """Reject a line that can't be served; returns as unless_too_fast does."""
        if self._limits_in_use.settings.outputs == "gauges":
            raise Refused("Gauges move each for itself: a line needs step and direction outputs.")
        going = sum(1 for count in steps.values() if count)
        pace = Pace(self.playbacks[ramp_axis].slew_interval, line_axes=going)
        share = self._limits_in_use.share([pace] if going else [])
        if share > 1:
            raise Rejected([self._line_too_fast(ramp_axis, pace, share)])
        return _rejecting(commands, lambda share: self._line_too_fast(ramp_axis, pace, share))

    @property
    def _limits_in_use(self) -> SpeedLimits:
        assert self._limits is not None
        return self._limits

    def _with_pins(self, commands: Sequence[AxisCommand]) -> None:
        """Reject an axis that is a gauge too many."""
        for each in commands:
            if self._limits_in_use.settings.outputs == "gauges" and each.axis >= MOST_GAUGES:
                raise Rejected([Rejection(_axis_field(each.field), each.axis, f"a gauge: 0 to {MOST_GAUGES - 1}")])

    def _paces(self, going: Mapping[int, int]) -> list[Pace]:
        return [Pace(interval, self.playbacks[axis].by_formula) for axis, interval in sorted(going.items())]

    def _too_fast(self, commands: Sequence[AxisCommand], going: Mapping[int, int], share: Fraction) -> Rejection:
        """Return the rejection of axes that would take such a share of the controller's processor."""
        paces = self._paces(going)
        slower = zip(sorted(going), self._limits_in_use.slowed_down(paces, share), strict=True)
        most = ", ".join(f"axis {axis} at most {self._speed(interval)}" for axis, interval in slower)
        fewer = "" if len(going) == 1 else " when they move at the same time, or fewer axes"
        allowed = f"{most}{fewer}{self._limits_in_use.or_narrower(paces)}; {_takes(share)}"
        if len(commands) == 1:
            return Rejection(commands[0].field, commands[0].value, allowed)
        return Rejection("axes", ", ".join(str(each.axis) for each in commands), allowed)

    def _line_too_fast(self, ramp_axis: int, pace: Pace, share: Fraction) -> Rejection:
        (slower,) = self._limits_in_use.slowed_down([pace], share)
        allowed = (
            f"an axis whose ramp has a slew speed of at most {self._speed(slower)}, for a line of "
            f"{pace.line_axes} axes{self._limits_in_use.or_narrower([pace])}; {_takes(share)}"
        )
        return Rejection("ramp_axis", ramp_axis, allowed)

    def _speed(self, interval: int) -> str:
        """Return an interval [ticks] as the speed that it allows, rounded down."""
        return f"{math.floor(speed_from_interval(interval, self._timer_hz)):,} steps/s"


def _end_of(fast: AxisCommand) -> End:
    return "high" if fast.value > 0 else "low"


def _no_switch(fast: AxisCommand) -> Rejection:
    end = _end_of(fast)
    allowed = (
        f"a speed towards an end of axis {fast.axis} where the settings name a limit switch; "
        f"at its {end} end none is named"
    )
    return Rejection(fast.field, fast.value, allowed)


def _axis_field(field: str) -> str:
    """Return what a rejection calls the axis next to a value."""
    if "." in field:
        return field.rpartition(".")[0] + ".axis"
    return field if field in ("axes", "traced_axis") else "axis"


def _takes(share: Fraction) -> str:
    return f"this takes {math.ceil(100 * share)} % of the controller's time"


def _rejecting(commands: Sequence[AxisCommand], too_fast: Callable[[Fraction], Rejection]) -> Rejecting:
    """Return what is wrong when the controller itself finds a value too far, or axes too fast, with their share."""

    def rejection(refusal: Refusal) -> Rejection:
        if refusal.status is ReplyStatus.TOO_FAST:
            return too_fast(Fraction(refusal.detail + 1, 100))  # it tells whole percent, rounded down
        to_blame = next((each for each in commands if each.axis == refusal.detail), commands[0])
        return Rejection(to_blame.field, to_blame.value, TARGETS, TARGET_LIMITS)

    return rejection
