"""What the axes of a grbl are told to do: jogs, one at a time, each in place of the one before."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from time import monotonic

from stepramp.controllers.axes import refuse_axes
from stepramp.controllers.contract import (
    Activity,
    AnswerUnknown,
    AxisCommand,
    AxisStatus,
    Ends,
    lasts_until_end_s,
)
from stepramp.controllers.grbl.conversation import Answered, Conversation
from stepramp.controllers.grbl.dialect import (
    DEAF_ALARMS,
    JOG_CANCEL,
    STATE_WORDS,
    Report,
    State,
    alarm_words,
)
from stepramp.controllers.grbl.jog import fastest_feed, feed_of, jog_line, refuse_runs_too_far, refuse_speeds
from stepramp.controllers.grbl.motion import SEGMENTS_PER_S
from stepramp.controllers.grbl.places import Places
from stepramp.controllers.grbl.stopping import Stopping
from stepramp.errors import DeviceLost, Refused, Rejected, Rescaled
from stepramp.units import SECONDS_PER_MINUTE

AHEAD_S = 1.5
"""So long a run goes on when nobody asks any more how it fares, besides slowing down [s]."""
FURTHER_S = 0.4
"""A run is told to go on once it would go on for so much less [s]: grbl plans up to fifteen lines ahead."""
PLANNED_AHEAD = 6
"""So many segments grbl has ready when it is told to slow down."""
REST_S = 30.0
"""What goes on is waited for so long, once it was told to end [s]."""
MOST_LOOKS = 40
"""It tells the workpiece's offset with each thirtieth report, at least."""


class Moves:
    """Moves axes, unless a stop has come since that was asked for.

    slowest_steps_per_s: that the firmware makes. ask_for_scales: learns the steps per mm anew if they are others than
    is known, and returns how they have changed. called: what people call it.
    """

    def __init__(
        self,
        conversation: Conversation,
        places: Places,
        stopping: Stopping,
        give_way: Callable[[float], None],
        ask_for_scales: Callable[[], Sequence[str]],
        called: str = "grbl",
    ) -> None:
        self._conversation = conversation
        self._called = called
        self._places = places
        self._stopping = stopping
        self._give_way = give_way
        self._ask_for_scales = ask_for_scales
        self.slowest_steps_per_s = 0.0
        self._aim: dict[int, int] = {}
        """Where axes jog to, as the controller counts [steps]."""
        self._speeds: dict[int, float] = {}
        """Of axes that run [steps/s]."""
        self._set_out_at: list[int] = []
        self.ends: Mapping[int, Ends] = {}
        """Where runs end by themselves, as positions are called here [steps]."""
        self._stops = 0
        """How many stops there were when that was asked for."""

    def look(self) -> Report:
        """Return how the controller fares, once its positions can be told."""
        for _ in range(MOST_LOOKS):
            report = self._conversation.look()
            if self._places.note(report):
                return report
        raise DeviceLost(f"The controller at {self._conversation.name} doesn't tell where its axes are.")

    def inability(self, report: Report) -> str | None:
        """Return what keeps the axes from being moved, as a sentence; None for nothing."""
        if report.state is State.ALARM:
            code = self._conversation.alarm
            if code in DEAF_ALARMS:
                return f"The controller can't move: {alarm_words(code)}. Reset it at the machine, or connect it again."
            why = "it was halted while it moved" if self._stopping.was_halted else alarm_words(code)
            return (
                f"The controller can't move: {why}. Where its axes are may be another place than it counts: home it "
                "at the machine, or set the position here, which unlocks it."
            )
        if report.state in STATE_WORDS:
            return f"The controller can't move: {STATE_WORDS[report.state]}."
        if self._places.changed:
            return f"The controller can't move: {self._places.change_words} Set the position here."
        return None

    def by(self, steps: Sequence[AxisCommand]) -> None:
        """Begin to move axes by so many steps, along a line, from where they would come to rest."""
        self._begin(steps, is_relative=True)

    def to(self, positions: Sequence[AxisCommand]) -> None:
        """Begin to move axes to positions [steps], along a line."""
        self._begin(positions, is_relative=False)

    def run(self, speeds: Sequence[AxisCommand]) -> None:
        """Run axes at speeds [steps/s], along a line; 0 has one of them run no more."""
        refuse_axes(speeds, len(self._places.axes))
        refuse_speeds(speeds, self._places.axes, self.slowest_steps_per_s)
        stops, now = self._stopping.count, self._running
        asked = now | _values(speeds)
        wanted = {axis: speed for axis, speed in asked.items() if speed}
        if not wanted:
            self._stopping.stop()
            return
        report = self._at_rest(asked, stops)
        self._set_out_at = self._places.counted(report)
        scales, ahead = self._places.axes, partial(self._ahead, passed_s=0.0)
        refuse_runs_too_far(speeds, wanted, ahead, scales, self.slowest_steps_per_s)
        self._jog(ahead(wanted), feed_of(wanted, scales), speeds, stops)
        self._speeds = wanted

    def go_on(self, report: Report) -> None:
        """Have axes that run go on, as long as somebody asks how they fare."""
        running = self._running
        if not running:
            return
        if report.state is not State.JOG:
            self._speeds = {}
            return
        counted = self._places.counted(report)
        passed_s = max((counted[axis] - self._set_out_at[axis]) / speed for axis, speed in running.items())
        targets, stops = self._ahead(running, passed_s), self._stopping.count
        if all(abs(targets[axis] - self._aim[axis]) < abs(running[axis]) * FURTHER_S for axis in targets):
            return
        asked = [AxisCommand(axis, speed, "speed_steps_per_s") for axis, speed in running.items()]
        try:
            self._jog(targets, feed_of(running, self._places.axes), asked, stops)
        except (Answered, AnswerUnknown, Rejected):
            # It ends at its soft limits, where a stop has it end, or at the furthest place that can be told.
            self._speeds = {}

    def axes(self, report: Report) -> tuple[AxisStatus, ...]:
        """Return what each axis does."""
        counted = self._places.counted(report)
        called = self._places.called(counted)
        found = []
        for axis, scale in enumerate(self._places.axes):
            activity = self._activity(report, axis)
            speed = self._speed(report, axis) if activity is not Activity.READY else 0.0
            rest = called[axis]
            if activity is Activity.MOVING and self._is_ours and axis not in self._running:
                rest += self._aim[axis] - counted[axis]
            elif activity is Activity.STOPPING and axis in self._aim:
                # No further than it was sent.
                left = self._aim[axis] - counted[axis]
                rest += int(math.copysign(min(abs(left), self._braking(axis, speed)), left))
            made = abs(counted[axis] - self._set_out_at[axis]) if self._set_out_at else 0
            found.append(
                AxisStatus(axis, activity, called[axis], rest, speed, made, steps_per_mm=float(scale.steps_per_mm))
            )
        return tuple(found)

    def steps_to_rest(self, axis: int, speed_steps_per_s: float) -> int:
        """Return how many steps slowing down from a speed [steps/s] takes: v² / 2a, and what is planned ahead."""
        return self._braking(axis, speed_steps_per_s) + math.ceil(PLANNED_AHEAD * speed_steps_per_s / SEGMENTS_PER_S)

    def rest_at(self, report: Report) -> None:
        """Take where the axes are as where they set out from: when a connection begins, and positions are set."""
        self._set_out_at, self._aim, self._speeds = self._places.counted(report), {}, {}

    def _braking(self, axis: int, speed_steps_per_s: float) -> int:
        return math.ceil(speed_steps_per_s**2 / (2 * self._places.axes[axis].acceleration_steps_per_s2))

    @property
    def _is_ours(self) -> bool:
        """Whether what goes on was asked for over this connection, and not stopped since."""
        return self._stopping.count == self._stops and bool(self._aim)

    @property
    def _running(self) -> dict[int, float]:
        return self._speeds if self._is_ours else {}

    def _begin(self, asked: Sequence[AxisCommand], *, is_relative: bool) -> None:
        refuse_axes(asked, len(self._places.axes))
        stops, values = self._stopping.count, _values(asked)
        if is_relative and self._running and self.look().is_under_way:
            raise Refused("An axis runs, so it isn't known yet where it comes to rest: say a position, or stop it.")
        heading = dict(self._aim) if self._is_ours else {}
        moves_now = self.look().state is State.JOG
        report = self._at_rest(values, stops)
        counted = self._places.counted(report)
        if is_relative:
            from_there = heading if moves_now else {}
            targets = {axis: from_there.get(axis, counted[axis]) + int(steps) for axis, steps in values.items()}
        else:
            targets = {axis: self._places.counted_of(axis, int(place)) for axis, place in values.items()}
        self._set_out_at = counted
        going = {axis: place for axis, place in targets.items() if place != counted[axis]}
        if going:
            self._jog(going, fastest_feed(list(going), self._places.axes), asked, stops)
        else:
            self._aim, self._stops = {}, stops
        self._speeds = {}

    def _jog(self, targets: Mapping[int, int], feed: str, asked: Sequence[AxisCommand], stops: int) -> None:
        line = jog_line(targets, self._places.axes, feed, asked)
        self._stopping.refuse_stopped(stops)
        try:
            self._conversation.ask(line)
        except DeviceLost:
            # Whether it moves isn't known, and nobody would hear where.
            self._stopping.give_up()
            raise
        finally:
            self._aim, self._stops = dict(targets), stops
            self._places.aim(targets)
        self._stopping.refuse_stopped(stops)

    def _at_rest(self, axes: Mapping[int, float], stops: int) -> Report:
        """Return how the controller fares once it rests: what these axes do ends. Refused while others move."""
        report = self.look()
        if (reason := self.inability(report)) is not None:
            raise Refused(reason)
        if report.state is State.JOG and self._is_ours and not set(self._aim) <= set(axes):
            others = ", ".join(str(axis) for axis in sorted(set(self._aim) - set(axes)))
            raise Refused(
                f"Axis {others} moves, and {self._called} moves all axes by one plan: wait, or stop it first."
            )
        goes_on = report.state is State.JOG and self._is_ours
        deadline_s = monotonic() + REST_S
        while report.state is State.JOG:
            self._stopping.refuse_stopped(stops)
            self._conversation.send(JOG_CANCEL)
            self._give_way(1 / SEGMENTS_PER_S)
            report = self.look()
            if monotonic() > deadline_s:
                raise Refused("What goes on doesn't come to rest: stop it first.")
        # While it jogs nobody can set them.
        rescaled = () if goes_on else self._ask_for_scales()
        refuse_axes([AxisCommand(axis, 0, "axes") for axis in axes], len(self._places.axes))
        self._stopping.refuse_stopped(stops)
        if (reason := self.inability(report)) is not None:
            raise Refused(reason)
        if rescaled:
            raise Rescaled(f"{', '.join(rescaled)}, so lengths are others now. Nothing was moved: ask again.")
        return report

    def _ahead(self, speeds: Mapping[int, float], passed_s: float) -> dict[int, int]:
        """Return where axes that run are sent to next, so that none has to slow down before it is sent further."""
        brake_s = max(
            abs(speed) / (2 * self._places.axes[axis].acceleration_steps_per_s2) for axis, speed in speeds.items()
        )
        called = dict(enumerate(self._places.called(self._set_out_at)))
        lasts_s = min(passed_s + brake_s + AHEAD_S, lasts_until_end_s(self.ends, called, speeds))
        return {axis: self._set_out_at[axis] + round(speed * lasts_s) for axis, speed in speeds.items()}

    def _activity(self, report: Report, axis: int) -> Activity:
        if not report.is_under_way:
            return Activity.READY
        if report.state is State.JOG and self._aim:
            if axis not in self._aim:
                return Activity.READY
            return Activity.STOPPING if self._stopping.slows_down else Activity.MOVING
        return Activity.STOPPING if report.state in (State.HOLD, State.DOOR) else Activity.MOVING

    def _speed(self, report: Report, axis: int) -> float:
        """Return the part that an axis has in the speed along the line [steps/s]."""
        scales, along = self._places.axes, self._aim
        ways = {each: (along[each] - self._set_out_at[each]) / float(scales[each].steps_per_mm) for each in along}
        length = math.hypot(*ways.values())
        share = abs(ways.get(axis, 0.0)) / length if length else 1.0
        feed = report.feed_per_min * self._places.mm_per_unit
        return feed / SECONDS_PER_MINUTE * float(scales[axis].steps_per_mm) * share


def _values(asked: Sequence[AxisCommand]) -> dict[int, float]:
    return {each.axis: each.value for each in sorted(asked, key=lambda each: each.axis)}
