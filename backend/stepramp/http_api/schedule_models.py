"""What the schedule's route takes and answers."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from stepramp.design import Design
from stepramp.http_api.answer import Answer, Numbers, WholeNumbers
from stepramp.http_api.error_items import TOLD, ToldAnswer
from stepramp.http_api.planning_models import MostPoints, WarningAnswer, refuse_more_numbers
from stepramp.ramp.schedule import MOST_AXES, Mode, Schedule, ScheduledAxis, conflicts_of, merged
from stepramp.validation import Document, ListOf, Within


class SchedulePayload(Document):
    """Designs whose moves begin together."""

    designs: Annotated[list[Design], ListOf("designs", most=MOST_AXES, least=1)] = Field(
        description=f"One to {MOST_AXES} designs, one an axis"
    )
    mode: Mode = Field(
        description="independent: each axis plays its own move with its own timer. line: straight in the space of all "
        "axes' steps; the first of the axes with most steps leads, and is slowed to what every axis allows"
    )
    max_points: MostPoints = Field(
        None, description="Thin each axis to about so many steps, the first and the last of them; null: every step"
    )
    shortest_spacing_us: Annotated[float, Within(0, 1_000_000, "µs")] = Field(
        20.0,
        description="Least time that the controller's interrupt needs between two pulses of different axes [µs]",
    )

    @model_validator(mode="after")
    def _can_be_answered(self) -> Self:
        each_and_merged = len(AxisPulsesAnswer.model_fields) + len(PulsesAnswer.model_fields)
        refuse_more_numbers(each_and_merged, self.designs, self.max_points)
        return self


class AxisPulsesAnswer(Answer):
    """Pulses of one axis, in order of time."""

    step: WholeNumbers = Field(description="Which steps the arrays are of, counted from 1 [steps]")
    time_s: Numbers = Field(description="Instant of the pulse of each step [s]")
    position_steps: WholeNumbers = Field(description="Position after the pulse of each step [steps]")
    speed_steps_per_s: Numbers = Field(
        description="Speed after the pulse of each step; along a line, the axis' even share of the leader's [steps/s]"
    )


class ScheduledAxisAnswer(Answer):
    """What one axis does."""

    name: str = Field(description="Name of its design")
    steps: int = Field(description="Length of its move, without sign [steps]")
    direction: Literal[1, -1] = Field(description="1 forwards, -1 backwards")
    duration_s: float = Field(
        description="From time 0 to the end of its last interval; along a line, to the end of the leader's [s]"
    )
    pulses: AxisPulsesAnswer

    @classmethod
    def of(cls, axis: ScheduledAxis) -> Self:
        """Return an axis of a schedule as an answer."""
        return cls(
            name=axis.name,
            steps=axis.steps,
            direction=axis.direction,
            duration_s=axis.pace.duration_s,
            pulses=axis,
        )


class PulsesAnswer(Answer):
    """Pulses of all axes in order of time; those of one instant in order of the axes."""

    time_s: Numbers = Field(description="Instant of each pulse [s]")
    axis: WholeNumbers = Field(description="Axis that pulses, counted from 0 in the order of the designs")
    position_steps: WholeNumbers = Field(description="Position of that axis after the pulse [steps]")


class ConflictAnswer(Answer):
    """Two pulses of different axes that are closer than the shortest spacing, but not at the same instant."""

    time_s: float = Field(description="Instant of the earlier pulse [s]")
    axes: tuple[int, int] = Field(description="Axis of the earlier pulse and axis of the later one, counted from 0")
    gap_us: float = Field(description="From the earlier to the later pulse [µs]")


class ConflictsAnswer(Answer):
    """Pairs of pulses that the controller can't serve in time."""

    count: int = Field(description="How many pairs there are, among all pulses [pairs]")
    first: list[ConflictAnswer] = Field(
        description="The first of them, at most 100, in order of the earlier pulse and then of the later one"
    )


class LimitAnswer(Answer):
    """What makes a line slower than its leader's own move."""

    field: str = Field(description="Path of the field in the request's body where it can be changed")
    axis: int = Field(description="Axis that limits, counted from 0")
    message: str = Field(description="What the axis allows, and what the line's ramp is for it")
    told: list[ToldAnswer] = Field(description=TOLD)


class ScheduleAnswer(Answer):
    """What one to four axes do from time 0 on."""

    axes: list[ScheduledAxisAnswer] = Field(description="The axes, in the order of the designs")
    schedule: PulsesAnswer = Field(description="The pulses that the axes' arrays hold, merged")
    conflicts: ConflictsAnswer
    duration_s: float = Field(description="From time 0 to the end of the last interval of all axes [s]")
    leader: int | None = Field(description="Axis that leads the line, counted from 0; null in mode independent")
    limits: list[LimitAnswer] = Field(description="What makes the line slower than its leader's own move")
    warnings: list[WarningAnswer]

    @classmethod
    def of(cls, schedule: Schedule, shortest_spacing_us: float, most_points: int | None) -> Self:
        """Return a schedule as an answer, each axis thinned to about so many points."""
        pulses = merged(schedule.axes)
        conflicts = conflicts_of(pulses, shortest_spacing_us)
        axes = schedule.axes
        if most_points is not None:
            axes = tuple(axis.thinned(most_points) for axis in axes)
            pulses = merged(axes)
        return cls(
            axes=[ScheduledAxisAnswer.of(axis) for axis in axes],
            schedule=pulses,
            conflicts=conflicts,
            duration_s=schedule.duration_s,
            leader=schedule.leader,
            limits=schedule.limits,
            warnings=schedule.warnings,
        )
