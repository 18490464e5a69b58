"""What the route over the own ramps of controllers takes and answers."""

from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field

from stepramp.controllers.own_ramp import Beside
from stepramp.design import Design
from stepramp.http_api.answer import Answer, Numbers, WholeNumbers
from stepramp.http_api.error_items import ErrorList
from stepramp.units import MICROSECONDS_PER_SECOND
from stepramp.validation import Document, Within

UNPLAYED: dict[int | str, dict[str, Any]] = {409: {"model": ErrorList, "description": "It isn't known what is played"}}
"""What routes answer that tell an own ramp, besides that."""


class OwnRampPayload(Document):
    """A design, and what is known of the axis that is to play it."""

    design: Design
    steps_per_mm: Annotated[float, Within(0.001, 1_000_000, "steps/mm", ", or null")] | None = Field(
        None, description="As the controller is set; null: the design's own, a degree standing for a mm [steps/mm]"
    )
    max_points: Annotated[int, Within(10, 100_000, "points")] = Field(
        2000, description="Thin the arrays to about so many steps that keep the curves' shapes"
    )


class OwnRampAnswer(Answer):
    """A design's move as a controller plays it."""

    step: WholeNumbers = Field(description="Which steps the arrays are of, counted from 1 [steps]")
    intervals_us: Numbers = Field(description="Wait after the pulse of each step [µs]")
    start_s: Numbers = Field(description="Instant of the pulse of each step [s]")
    speed_steps_per_s: Numbers = Field(description="Speed of each interval [steps/s]")
    relative_error: Numbers = Field(description="Interval over that of the design, less 1: 0.01 is 1 % too long")
    direction: int = Field(description="1 forwards, -1 backwards")
    max_relative_error: float = Field(description="The relative error of all steps that is furthest from 0")
    max_error_step: int = Field(description="The first step that has it, counted from 1 [steps]")
    duration_s: float = Field(description="How long the controller takes [s]")
    planned_duration_s: float = Field(description="How long the design's move takes [s]")
    losses: list[str] = Field(description="What of the design the controller doesn't keep, as sentences")

    @classmethod
    def of(cls, beside: Beside, max_points: int) -> Self:
        """Return both ramps as an answer."""
        kept = beside.kept(max_points)
        waits = beside.own.intervals_s[kept]
        error, step = beside.largest_error
        return cls(
            step=kept + 1,
            intervals_us=waits * MICROSECONDS_PER_SECOND,
            start_s=beside.start_s[kept],
            speed_steps_per_s=(1 / waits).astype(np.float32),
            relative_error=beside.relative_error[kept].astype(np.float32),
            direction=beside.profile.direction,
            max_relative_error=error,
            max_error_step=step,
            duration_s=beside.duration_s,
            planned_duration_s=beside.profile.duration_s,
            losses=list(beside.own.losses),
        )
