"""What the routes take that move the axes of a device, and what they answer of traces."""

from collections.abc import Sequence
from typing import Annotated, Self

from pydantic import Field, StrictBool, model_validator

from stepramp.controllers.axes import MOST_AXES, AxisNumber, AxisNumbersAsGiven
from stepramp.controllers.contract import AxisCommand, Trace
from stepramp.devices.homing import Homing
from stepramp.devices.leases import Lease
from stepramp.devices.shuttle import Shuttle
from stepramp.devices.soft_limits import Span
from stepramp.errors import Limits
from stepramp.http_api.answer import Answer, Numbers, WholeNumbers
from stepramp.validation import Document, ListOf, ListOrNull, Text, Within, refuse

LEAST_STEPS, MOST_STEPS = -(2**31), 2**31 - 1
NOT_ZERO = ", but not 0"
Steps = Annotated[int, Within(LEAST_STEPS, MOST_STEPS, "steps")]
StepsAway = Annotated[int, Within(LEAST_STEPS, MOST_STEPS, "steps", NOT_ZERO)]
Speed = Annotated[float, Within(-1_000_000, 1_000_000, "steps/s")]
AXIS = "Which axis, from 0"


class AxisMove(Document):
    """Where one axis is to move: one of the two."""

    axis: AxisNumber = Field(description=AXIS)
    by_steps: Steps | None = Field(None, description="How far, from where it would come to rest [steps]")
    to_steps: Steps | None = Field(None, description="Which position to move to [steps]")

    @model_validator(mode="after")
    def _one_of_two(self) -> Self:
        _refuse_both_or_none(self.by_steps, self.to_steps)
        return self


class Motion(Document):
    """What begins a motion."""

    wait_s: Annotated[float, Within(0, 86_400, "s")] = Field(
        0.0,
        description="How long the answer may wait until no axis moves any more; 0: it tells how the motion begins [s]",
    )


class MovePayload(Motion):
    """Where to move: axis 0 by so many steps or to a position, or several axes that begin together."""

    by_steps: Steps | None = Field(
        None, description="How far axis 0 moves from where it would come to rest, negative for backwards [steps]"
    )
    to_steps: Steps | None = Field(None, description="Which position axis 0 moves to [steps]")
    axes: Annotated[list[AxisMove] | None, ListOrNull("moves of axes", most=MOST_AXES, least=1)] = Field(
        None, description="Moves of several axes, all of them by_steps or all of them to_steps"
    )

    @model_validator(mode="after")
    def _one_of_three(self) -> Self:
        if self.axes is None:
            _refuse_both_or_none(self.by_steps, self.to_steps)
            if self.by_steps == 0:
                refuse("by_steps", 0, _steps(NOT_ZERO))
            return self
        refuse_own_axes(self.axes, {"by_steps": self.by_steps, "to_steps": self.to_steps})
        relative = self.axes[0].by_steps is not None
        for number, each in enumerate(self.axes):
            if (each.by_steps is not None) != relative:
                given = "by_steps" if relative else "to_steps"
                refuse(f"axes.{number}.{given}", None, f"a value, since axes.0 has {given}")
        return self

    @property
    def is_relative(self) -> bool:
        """Whether the axes move by steps; otherwise to positions."""
        return (self.by_steps if self.axes is None else self.axes[0].by_steps) is not None

    @property
    def commands(self) -> list[AxisCommand]:
        """What is asked of the axes."""
        name = "by_steps" if self.is_relative else "to_steps"
        return _commands(self.axes, name, getattr(self, name))


class ShuttlePayload(Motion):
    """How one axis is to go there and back."""

    axis: AxisNumber = Field(0, description=AXIS)
    by_steps: StepsAway = Field(
        description="How far it goes, from where it is at rest, negative for backwards [steps]",
        json_schema_extra={"not": {"const": 0}},
    )
    times: Annotated[int, Within(1, 10_000)] = Field(1, description="How often there and back")
    pause_s: Annotated[float, Within(0, 3600, "s")] = Field(0.0, description="Pause at each end [s]")

    @model_validator(mode="after")
    def _somewhere(self) -> Self:
        if self.by_steps == 0:
            refuse("by_steps", 0, _steps(NOT_ZERO))
        return self

    def shuttle(self, page: str | None) -> Shuttle:
        """Return it before it begins, for whoever asks."""
        return Shuttle(self.axis, self.by_steps, self.times, self.pause_s, page)

    @property
    def command(self) -> AxisCommand:
        """What is asked of the axis first."""
        return AxisCommand(self.axis, self.by_steps, "by_steps")


class AxisRun(Document):
    """How fast one axis is to run."""

    axis: AxisNumber = Field(description=AXIS)
    speed_steps_per_s: Speed = Field(description="Speed, negative for backwards; 0 stops [steps/s]")


class RunPayload(Motion):
    """How fast to run: axis 0, or several axes."""

    speed_steps_per_s: Speed | None = Field(
        None, description="Speed of axis 0, up to its ramp's slew speed, negative for backwards; 0 stops [steps/s]"
    )
    axes: Annotated[list[AxisRun] | None, ListOrNull("speeds of axes", most=MOST_AXES, least=1)] = Field(
        None, description="Speeds of several axes"
    )
    for_s: Annotated[float, Within(0.05, 86_400, "s")] = Field(
        2.0, description="How long; then the axes slow down, unless it was asked again before [s]"
    )

    name: Annotated[str, Text(100)] = Field("", description="Name of the run, to renew it by: another one for each run")
    renews: StrictBool = Field(
        False,
        description="Let the run of this name go on, at the same speeds; refused once it has slowed down",
    )

    @model_validator(mode="after")
    def _one_of_two(self) -> Self:
        _refuse_unless_one(self.axes, "speed_steps_per_s", self.speed_steps_per_s, "a speed in steps/s")
        if self.renews and not self.name:
            refuse("name", "", "the name that the run began with, since it is to be renewed")
        return self

    def lease(self, page: str | None) -> Lease:
        """Return what the axes run on, for whoever asks."""
        return Lease({each.axis: each.value for each in self.commands}, self.for_s, page, name=self.name)

    @property
    def commands(self) -> list[AxisCommand]:
        """What is asked of the axes."""
        return _commands(self.axes, "speed_steps_per_s", self.speed_steps_per_s)


class AxisSteps(Document):
    """How far one axis goes along a line."""

    axis: AxisNumber = Field(description=AXIS)
    by_steps: Steps = Field(description="How far from here, negative for backwards [steps]")


class LinePayload(Motion):
    """A straight line of several axes, which begin and end together."""

    axes: Annotated[list[AxisSteps], ListOf("axes and how far they go", most=MOST_AXES, least=1)] = Field(
        description="The axes, and how far they go"
    )
    ramp_axis: AxisNumber | None = Field(
        None,
        description="Whose ramp the axis with most steps plays; null: that of the slowest axis that goes along, so "
        "that none is faster than on its own",
    )

    @model_validator(mode="after")
    def _some(self) -> Self:
        refuse_own_axes(self.axes, {})
        if not any(each.by_steps for each in self.axes):
            refuse("axes.0.by_steps", self.axes[0].by_steps, _steps(", not 0 for all axes"))
        return self

    @property
    def commands(self) -> list[AxisCommand]:
        """What is asked of the axes."""
        return _commands(self.axes, "by_steps", None)


class AxisPosition(Document):
    """What the place of one axis is to be called."""

    axis: AxisNumber = Field(description=AXIS)
    position_steps: Steps = Field(description="Its position from now on [steps]")


class PositionPayload(Document):
    """What the place of axis 0, or of several axes, is to be called; nothing moves."""

    position_steps: Steps | None = Field(None, description="Position of axis 0 from now on [steps]")
    axes: Annotated[list[AxisPosition] | None, ListOrNull("positions of axes", most=MOST_AXES, least=1)] = Field(
        None, description="Positions of several axes"
    )

    @model_validator(mode="after")
    def _one_of_two(self) -> Self:
        _refuse_unless_one(self.axes, "position_steps", self.position_steps, "a position in steps")
        return self

    @property
    def commands(self) -> list[AxisCommand]:
        """What is asked of the axes."""
        return _commands(self.axes, "position_steps", self.position_steps)


class AxisLimits(Document):
    """Positions that one axis is kept within."""

    axis: AxisNumber = Field(description=AXIS)
    lowest_steps: Steps | None = Field(None, description="Lowest position; null: no limit [steps]")
    highest_steps: Steps | None = Field(None, description="Highest position; null: no limit [steps]")

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.lowest_steps is not None and self.highest_steps is not None and self.highest_steps < self.lowest_steps:
            limits = Limits(lowest=self.lowest_steps, unit="steps", is_whole=True, note=", the lowest")
            refuse("highest_steps", self.highest_steps, limits)
        return self


class SoftLimitsPayload(Document):
    """Positions that axes are kept within from now on; those that are not named keep theirs."""

    axes: Annotated[list[AxisLimits], ListOf("limits of axes")] = Field(description="The axes, and their limits")

    @model_validator(mode="after")
    def _some(self) -> Self:
        refuse_own_axes(self.axes, {})
        axes = [each.axis for each in self.axes]
        for number, axis in enumerate(axes):
            if axis in axes[:number]:
                refuse(f"axes.{number}.axis", axis, "each axis once")
        return self

    @property
    def spans(self) -> dict[int, Span]:
        """The limits by axes."""
        return {each.axis: Span(each.lowest_steps, each.highest_steps) for each in self.axes}


class ZeroPayload(Motion):
    """Gauges that are to run against their stop, which is then position 0."""

    axes: AxisNumbersAsGiven = Field((0,), description="Which axes, each once")
    steps: Annotated[int, Within(1, 65_535, "steps")] = Field(
        description="How far they move backwards: at least their whole range [steps]"
    )

    @model_validator(mode="after")
    def _some(self) -> Self:
        refuse_own_axes(self.axes, {})
        return self


class AxisHome(Document):
    """How one axis is to find its limit switch."""

    axis: AxisNumber = Field(description=AXIS)
    fast_steps_per_s: Speed = Field(
        description="Speed towards the switch, negative for the one at its low end, not 0, up to its ramp's slew speed "
        "[steps/s]",
        json_schema_extra={"not": {"const": 0}},
    )
    position_steps: Steps = Field(0, description="What the place that it finds is to be called afterwards [steps]")


class HomePayload(Motion):
    """How axes are to find their limit switches: each by itself."""

    axes: Annotated[list[AxisHome], ListOf("axes, each with how it finds its switch", most=MOST_AXES, least=1)] = Field(
        description="The axes, and towards which switch"
    )
    slow_steps_per_s: Annotated[float, Within(0, 1_000_000, "steps/s", ", but not 0")] = Field(
        description="Speed of all of them away from the switch, and back to it: the slower, the more exact [steps/s]",
        json_schema_extra={"not": {"const": 0}},
    )
    back_off_steps: Annotated[int, Within(1, 65_535, "steps")] = Field(
        50, description="How far they go on from where the switch lets go, before they come back slowly [steps]"
    )
    for_s: Annotated[float, Within(0.05, 86_400, "s")] = Field(
        60.0, description="How long it may take; then the axes slow down, and where they are stays unknown [s]"
    )

    @model_validator(mode="after")
    def _some(self) -> Self:
        refuse_own_axes(self.axes, {})
        axes = [each.axis for each in self.axes]
        for number, each in enumerate(self.axes):
            if each.axis in axes[:number]:
                refuse(f"axes.{number}.axis", each.axis, "each axis once")
            if not each.fast_steps_per_s:
                refuse(f"axes.{number}.fast_steps_per_s", 0, "a speed in steps/s towards the switch, but not 0")
        if not self.slow_steps_per_s:
            refuse("slow_steps_per_s", 0, "a speed in steps/s, but not 0")
        return self

    @property
    def homing(self) -> Homing:
        """What is asked of the axes."""
        return Homing(
            _commands(self.axes, "fast_steps_per_s", None),
            AxisCommand(0, self.slow_steps_per_s, "slow_steps_per_s"),
            self.back_off_steps,
            {each.axis: each.position_steps for each in self.axes},
        )

    def lease(self, page: str | None) -> Lease:
        """Return what the axes run on, for whoever asks."""
        return Lease({each.axis: each.fast_steps_per_s for each in self.axes}, self.for_s, page, is_to_home=True)


class TracePayload(Document):
    """Whose moves are to be traced from now on."""

    traced_axis: AxisNumber | None = Field(description="Which axis, from 0; null: none")
    every_steps: Annotated[int, Within(0, 65_535, "steps")] = Field(
        0, description="Trace every so many-th step, or more seldom if the port can't carry them [steps]"
    )


class TracingAnswer(Answer):
    """What will be traced."""

    traced_axis: int | None = Field(description="Axis whose moves are traced from now on; null: none")
    every_steps: int = Field(description="Of so many steps one is traced [steps]")
    next_number: int = Field(
        description="The number of the next motion that the axis is told; each one after it, as each leg there and "
        "back, has the next number, until the device is lost or disconnected"
    )


class TraceAnswer(Answer):
    """When the steps of the last traced move were made, by the controller's own timer."""

    traced_axis: int = Field(description="Axis that moved")
    number: int = Field(description="Which motion it was, as next_number told it when it was asked to be traced")
    every_steps: int = Field(description="Of so many steps one was traced [steps]")
    timer_hz: int = Field(description="Ticks a second of the controller's timer [Hz]")
    complete: bool = Field(description="Whether the move has ended and all of its trace is here")
    changed: bool = Field(description="Whether the move was changed on its way; the trace then ends there")
    step: WholeNumbers = Field(
        description="Which steps, counted from 1; those that the port could not carry are left out, and those after "
        "the first 500,000 [steps]"
    )
    planned_ticks: WholeNumbers = Field(description="When they were to be made, from the first step on [ticks]")
    measured_ticks: WholeNumbers = Field(description="When they were made, from the first step on [ticks]")
    deviation_us: Numbers = Field(description="How much later than planned they were made [µs]")

    @classmethod
    def of(cls, trace: Trace) -> Self:
        """Return a trace as an answer."""
        return cls(
            traced_axis=trace.axis,
            number=trace.number,
            every_steps=trace.every_steps,
            timer_hz=trace.timer_hz,
            complete=trace.complete,
            changed=trace.changed,
            step=trace.step,
            planned_ticks=trace.planned_ticks,
            measured_ticks=trace.measured_ticks,
            deviation_us=trace.deviation_us,
        )


def _commands(axes: Sequence[Document] | None, name: str, own: float | None) -> list[AxisCommand]:
    """Return what is asked of axes, or of axis 0, with what rejections call it."""
    if axes is None:
        return [] if own is None else [AxisCommand(0, own, name)]
    fields = [(getattr(each, "axis"), getattr(each, name)) for each in axes]  # noqa: B009  # of several models
    return [AxisCommand(axis, value, f"axes.{number}.{name}") for number, (axis, value) in enumerate(fields)]


def _steps(note: str) -> Limits:
    return Limits(LEAST_STEPS, MOST_STEPS, "steps", is_whole=True, note=note)


def _refuse_both_or_none(by_steps: int | None, to_steps: int | None) -> None:
    if by_steps is not None and to_steps is not None:
        refuse("to_steps", to_steps, "nothing, since by_steps is given")
    if by_steps is None and to_steps is None:
        refuse("by_steps", None, "a whole number of steps, or else to_steps")


def refuse_own_axes(axes: Sequence[object], own: dict[str, int | None]) -> None:
    """Refuse a list of no axes or too many, and what is given of axis 0 next to a list."""
    if not 1 <= len(axes) <= MOST_AXES:
        refuse("axes", f"{len(axes)} axes", f"a list of 1 to {MOST_AXES} axes")
    for name, value in own.items():
        if value is not None:
            refuse(name, value, "nothing, since axes is given")


def _refuse_unless_one(axes: Sequence[object] | None, name: str, value: float | None, allowed: str) -> None:
    """Refuse a list of axes next to what is given of axis 0, and neither of them."""
    if axes is not None and value is not None:
        refuse(name, value, "nothing, since axes is given")
    if axes is not None:
        refuse_own_axes(axes, {})
    elif value is None:
        refuse(name, None, f"{allowed}, or else axes")
