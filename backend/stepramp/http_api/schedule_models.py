"""What the schedule's route answers: described for the API's page, and filled from a schedule.

The answer is written straight to JSON, arrays and all; the models only describe it.
"""

from typing import Any, Literal

from pydantic import BaseModel, Field

from stepramp.http_api.planning_models import WarningAnswer
from stepramp.ramp.schedule import Axis, Schedule, conflicts_of, merged


class AxisPulsesAnswer(BaseModel):
    """Pulses of one axis, in order of time."""

    step: list[int] = Field(description="Which steps the arrays are of, counted from 1 [steps]")
    time_s: list[float] = Field(description="Instant of the pulse of each step [s]")
    position_steps: list[int] = Field(description="Position after the pulse of each step [steps]")
    speed_steps_per_s: list[float] = Field(
        description="Speed after the pulse of each step; along a line, the axis' even share of the leader's [steps/s]"
    )


class AxisAnswer(BaseModel):
    """What one axis does."""

    name: str = Field(description="Name of its design")
    steps: int = Field(description="Length of its move, without sign [steps]")
    direction: Literal[1, -1] = Field(description="1 forwards, -1 backwards")
    duration_s: float = Field(
        description="From time 0 to the end of its last interval; along a line, to the end of the leader's [s]"
    )
    pulses: AxisPulsesAnswer


class PulsesAnswer(BaseModel):
    """Pulses of all axes in order of time; those of one instant in order of the axes."""

    time_s: list[float] = Field(description="Instant of each pulse [s]")
    axis: list[int] = Field(description="Axis that pulses, counted from 0 in the order of the designs")
    position_steps: list[int] = Field(description="Position of that axis after the pulse [steps]")


class ConflictAnswer(BaseModel):
    """Two pulses of different axes that are closer than the shortest spacing, but not at the same instant."""

    time_s: float = Field(description="Instant of the earlier pulse [s]")
    axes: tuple[int, int] = Field(description="Axis of the earlier pulse and axis of the later one, counted from 0")
    gap_us: float = Field(description="From the earlier to the later pulse [µs]")


class ConflictsAnswer(BaseModel):
    """Pairs of pulses that the controller can't serve in time."""

    count: int = Field(description="How many pairs there are, among all pulses [pairs]")
    first: list[ConflictAnswer] = Field(
        description="The first of them, at most 100, in order of the earlier pulse and then of the later one"
    )


class LimitAnswer(BaseModel):
    """What makes a line slower than its leader's own move."""

    field: str = Field(description="Path of the field in the request's body where it can be changed")
    axis: int = Field(description="Axis that limits, counted from 0")
    message: str = Field(description="What the axis allows, and what the line's ramp is for it")


class ScheduleAnswer(BaseModel):
    """What one to four axes do from time 0 on."""

    axes: list[AxisAnswer] = Field(description="The axes, in the order of the designs")
    schedule: PulsesAnswer = Field(description="The pulses that the axes' arrays hold, merged")
    conflicts: ConflictsAnswer
    duration_s: float = Field(description="From time 0 to the end of the last interval of all axes [s]")
    leader: int | None = Field(description="Axis that leads the line, counted from 0; null in mode independent")
    limits: list[LimitAnswer] = Field(description="What makes the line slower than its leader's own move")
    warnings: list[WarningAnswer]


def schedule_content(schedule: Schedule, shortest_spacing_us: float, most_points: int | None) -> dict[str, Any]:
    """Return a schedule as a ScheduleAnswer's content, each axis thinned to about so many points."""
    pulses = merged(schedule.axes)
    conflicts = conflicts_of(pulses, shortest_spacing_us)
    axes = schedule.axes
    if most_points is not None:
        axes = tuple(axis.thinned(most_points) for axis in axes)
        pulses = merged(axes)
    return {
        "axes": [_axis_content(axis) for axis in axes],
        "schedule": vars(pulses),
        "conflicts": {"count": conflicts.count, "first": [vars(conflict) for conflict in conflicts.first]},
        "duration_s": schedule.duration_s,
        "leader": schedule.leader,
        "limits": [vars(limit) for limit in schedule.limits],
        "warnings": [vars(warning) for warning in schedule.warnings],
    }


def _axis_content(axis: Axis) -> dict[str, Any]:
    return {
        "name": axis.name,
        "steps": axis.steps,
        "direction": axis.direction,
        "duration_s": axis.pace.duration_s,
        "pulses": {
            "step": axis.step,
            "time_s": axis.time_s,
            "position_steps": axis.position_steps,
            "speed_steps_per_s": axis.speed_steps_per_s,
        },
    }
