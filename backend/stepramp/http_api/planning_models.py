"""What the planning routes answer: described for the API's page, and filled from profiles and error curves.

The answers are written straight to JSON, arrays and all; the models only describe them.
"""

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, Field

from stepramp.design import Design, MethodName
from stepramp.ramp.error_curves import ErrorCurve
from stepramp.ramp.profile import Profile
from stepramp.ramp.thinning import kept_steps


class PhaseAnswer(BaseModel):
    """A stretch of the move."""

    name: Literal["accelerate", "slew", "decelerate"]
    first_step: int = Field(description="First step, counted from 1 [steps]")
    last_step: int = Field(description="Last step, counted from 1 [steps]")


class SummaryAnswer(BaseModel):
    """The move in a few figures."""

    steps: int = Field(description="Length of the move [steps]")
    duration_s: float = Field(description="From pulse 1 to the end of the last interval [s]")
    peak_speed_steps_per_s: float = Field(description="Highest speed of an interval [steps/s]")
    accelerate_steps: int = Field(description="Steps of the acceleration [steps]")
    slew_steps: int = Field(description="Steps at slew speed [steps]")
    decelerate_steps: int = Field(description="Steps of the deceleration [steps]")


class WarningAnswer(BaseModel):
    """Something that works, but not as the design says."""

    field: str | None = Field(description="Path of the field in the request's body where it can be changed")
    message: str = Field(description="What happens and what to change")


class ProfileAnswer(BaseModel):
    """One planned move. Pulse 1 is at time 0; pulse i + 1 comes intervals_ticks of step i later."""

    step: list[int] = Field(description="Which steps the arrays are of, counted from 1 [steps]")
    intervals_ticks: list[int] = Field(description="Wait after the pulse of each step [ticks]")
    time_s: list[float] = Field(description="Instant of the pulse of each step [s]")
    position_steps: list[int] = Field(description="Position after the pulse of each step [steps]")
    speed_steps_per_s: list[float] = Field(description="Speed of each interval, v = F / p (7) [steps/s]")
    phases: list[PhaseAnswer] = Field(description="Stretches of the move that have steps, in order of time")
    summary: SummaryAnswer
    warnings: list[WarningAnswer]


class ExtremeAnswer(BaseModel):
    """The value of a curve that is furthest from 0."""

    value: float
    step: int = Field(description="First step that has it, counted from 1 [steps]")


class ErrorCurveAnswer(BaseModel):
    """One method's errors against the reference."""

    method: MethodName
    step: list[int] = Field(description="Which steps the arrays are of, counted from 1 [steps]")
    relative_error: list[float] = Field(description="Interval over reference interval, less 1: 0.01 is 1 % too long")
    tick_error: list[float] = Field(description="Interval less reference interval [ticks]")
    largest_relative_error: ExtremeAnswer
    largest_tick_error: ExtremeAnswer = Field(description="[ticks]")


class ErrorsAnswer(BaseModel):
    """Errors of methods against a reference that is not rounded to ticks."""

    reference: MethodName
    methods: list[ErrorCurveAnswer]


class ExampleAnswer(BaseModel):
    """A design to start from."""

    title: str
    description: str
    design: Design


class ExamplesAnswer(BaseModel):
    """Designs to start from."""

    examples: list[ExampleAnswer]


class HealthAnswer(BaseModel):
    """The server works."""

    status: Literal["ok"]
    version: str


def profile_content(profile: Profile, most_points: int | None) -> dict[str, Any]:
    """Return a profile as a ProfileAnswer's content, thinned to about so many points."""
    kept = _kept(profile.intervals_ticks, profile, most_points)
    return {
        "step": kept + 1,
        "intervals_ticks": profile.intervals_ticks[kept],
        "time_s": profile.time_s[kept],
        "position_steps": profile.position_steps[kept],
        "speed_steps_per_s": profile.speed_steps_per_s[kept],
        "phases": [vars(phase) for phase in profile.phases],
        "summary": {
            "steps": profile.intervals_ticks.size,
            "duration_s": profile.duration_s,
            "peak_speed_steps_per_s": profile.speed_steps_per_s.max(),
            "accelerate_steps": profile.steps_of("accelerate"),
            "slew_steps": profile.steps_of("slew"),
            "decelerate_steps": profile.steps_of("decelerate"),
        },
        "warnings": [
            {"field": warning.field and f"design.{warning.field}", "message": warning.message}
            for warning in profile.warnings
        ],
    }


def errors_content(reference: MethodName, curves: Sequence[ErrorCurve], most_points: int | None) -> dict[str, Any]:
    """Return error curves as an ErrorsAnswer's content, each thinned to about so many points."""
    return {"reference": reference, "methods": [_curve_content(curve, most_points) for curve in curves]}


def _curve_content(curve: ErrorCurve, most_points: int | None) -> dict[str, Any]:
    kept = _kept(curve.relative_error, curve.profile, most_points)
    return {
        "method": curve.method,
        "step": kept + 1,
        "relative_error": curve.relative_error[kept],
        "tick_error": curve.tick_error[kept],
        "largest_relative_error": vars(curve.largest_relative_error),
        "largest_tick_error": vars(curve.largest_tick_error),
    }


def _kept(
    values: NDArray[np.int64] | NDArray[np.float64], profile: Profile, most_points: int | None
) -> NDArray[np.int64]:
    return kept_steps(values, profile.phases, most_points or values.size)
