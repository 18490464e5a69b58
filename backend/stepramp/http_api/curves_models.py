"""What the route for plots takes and answers.

The answer is columns of numbers as short as they can be written: instants and intervals as whole ticks, exact, and
what is only drawn as 32-bit floats. Speeds and positions are left to whoever draws: F / p (7), and the step itself.
"""

from typing import Annotated, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, StrictBool

from stepramp.design import MOST_NAMES, Design, MethodName
from stepramp.errors import Rejected
from stepramp.http_api.answer import Answer, Numbers, WholeNumbers
from stepramp.http_api.planning_models import (
    ErrorFiguresAnswer,
    MethodFailure,
    PhaseAnswer,
    StepOfMove,
    SummaryAnswer,
    WarningAnswer,
    figures,
)
from stepramp.methods import REFERENCE
from stepramp.ramp.drawing import Drawing, Drawn
from stepramp.ramp.error_curves import Parts
from stepramp.ramp.motion import Motion
from stepramp.validation import Document, ListOf, Within


class CurvesPayload(Document):
    """A design, and what is to be drawn of it."""

    design: Design
    methods: Annotated[list[MethodName], ListOf("method names", most=MOST_NAMES)] = Field(
        description="Methods to draw, each with the design's arithmetic or else the one usual for it"
    )
    reference: MethodName = Field(REFERENCE, description="Method that they are compared with")
    max_points: Annotated[int, Within(10, 100_000, "points")] = Field(
        2000, description="Thin each method's arrays to about so many steps that keep the curves' shapes"
    )
    first_step: StepOfMove = Field(
        None,
        description="First step of a part that gets the points; the rest is thinned to about a quarter as many. "
        "Null: the move's first [steps]",
    )
    last_step: StepOfMove = Field(None, description="Last step of that part; null: the move's last [steps]")
    acceleration: StrictBool = Field(False, description="Whether the implied acceleration is wanted")
    parts: StrictBool = Field(False, description="Whether the parts of the error are wanted")
    motion: StrictBool = Field(False, description="Whether the planned acceleration and jerk are wanted")
    segment_bound_ticks: Annotated[int, Within(0, 10_000, "ticks", ", or null for no segments")] | None = Field(
        None,
        description="Bound of the segments whose part of the error is given among the parts [ticks]; null: no segments",
    )

    @property
    def drawing(self) -> Drawing:
        """What is to be drawn."""
        span = (self.first_step or 1, self.last_step or abs(self.design.move.steps))
        return Drawing(
            design=self.design,
            chosen=tuple(dict.fromkeys(self.methods)),
            reference=self.reference,
            most_points=self.max_points,
            span=None if self.first_step is self.last_step is None else span,
            with_acceleration=self.acceleration,
            with_parts=self.parts,
            with_motion=self.motion,
            segment_bound_ticks=self.segment_bound_ticks,
        )


class PartsAnswer(Answer):
    """Where the error of each interval comes from; the first three together are that of the planned interval."""

    method: Numbers = Field(description="Part of the method itself [ticks]")
    arithmetic: Numbers = Field(description="Part of the arithmetic [ticks]")
    rounding: Numbers = Field(description="Part of the rounding [ticks]")
    compression: Numbers = Field(description="Part of the segments [ticks]")

    @classmethod
    def of(cls, parts: Parts, kept: NDArray[np.int64]) -> Self:
        """Return the parts of the error at the kept steps."""
        return cls(**{name: _short(part[kept]) for name, part in vars(parts).items()})


class MotionAnswer(Answer):
    """What the intervals ask of a motor before they are rounded to ticks."""

    acceleration_steps_per_s2: Numbers = Field(description="(v_i² - v_(i-1)²) / 2 along each step [steps/s²]")
    jerk_steps_per_s3: Numbers = Field(description="(a_(i+1) - a_i) v_i from each step to the next [steps/s³]")

    @classmethod
    def of(cls, motion: Motion, kept: NDArray[np.int64]) -> Self:
        """Return acceleration and jerk at the kept steps."""
        return cls(**{name: _short(curve[kept]) for name, curve in vars(motion).items()})


class MethodCurvesAnswer(ErrorFiguresAnswer):
    """One method's move, thinned. A run of equal intervals has its two ends; between two steps, lines are straight."""

    method: MethodName
    step: WholeNumbers = Field(description="Which steps the arrays are of, counted from 1 [steps]")
    intervals_ticks: WholeNumbers = Field(description="Wait after the pulse of each step [ticks]")
    start_ticks: WholeNumbers = Field(description="Instant of the pulse of each step [ticks]")
    relative_error: Numbers = Field(description="Interval over reference interval, less 1: 0.01 is 1 % too long")
    implied_acceleration_steps_per_s2: Numbers | None = Field(
        None, description="(v_i² - v_(i-1)²) / 2; left out unless asked for [steps/s²]"
    )
    parts: PartsAnswer | None = Field(None, description="Left out unless asked for")
    motion: MotionAnswer | None = Field(None, description="Left out unless asked for")
    phases: list[PhaseAnswer] = Field(description="Stretches of the move that have steps, in order of time")
    summary: SummaryAnswer
    warnings: list[WarningAnswer]

    @classmethod
    def of(cls, method: MethodName, drawn: Drawn, with_acceleration: bool) -> Self:
        """Return one method's move as it is drawn."""
        kept, judged, profile = drawn.kept, drawn.judged, drawn.judged.profile
        asked_for: dict[str, object] = {}
        if with_acceleration:
            asked_for["implied_acceleration_steps_per_s2"] = _short(judged.implied_acceleration_steps_per_s2[kept])
        if drawn.parts is not None:
            asked_for["parts"] = PartsAnswer.of(drawn.parts, kept)
        if drawn.motion is not None:
            asked_for["motion"] = MotionAnswer.of(drawn.motion, kept)
        return cls(
            method=method,
            step=kept + 1,
            intervals_ticks=judged.played_ticks[kept],
            start_ticks=drawn.start_ticks,
            relative_error=_short(judged.relative_error[kept]),
            phases=profile.phases,
            summary=SummaryAnswer.of(profile),
            warnings=WarningAnswer.all_of(profile),
            **figures(judged),
            **asked_for,
        )


class CurvesAnswer(Answer):
    """A design's move by several methods, ready to be drawn."""

    reference: MethodName
    timer_hz: float = Field(description="Ticks a second [Hz]")
    direction: int = Field(description="1 forwards, -1 backwards: the position after step i is i times this")
    methods: list[MethodCurvesAnswer] = Field(description="In the order asked for, without those that failed")
    failures: list[MethodFailure] = Field(description="Methods that don't fit the design, and why")

    @classmethod
    def of(cls, drawing: Drawing) -> Self:
        """Return a drawing as an answer; its methods are computed one by one."""
        answer = cls(
            reference=drawing.reference,
            timer_hz=drawing.design.timer.frequency_hz,
            direction=1 if drawing.design.move.steps > 0 else -1,
            methods=[],
            failures=[],
        )
        for method, drawn in drawing.methods():
            if isinstance(drawn, Rejected):
                answer.failures.append(MethodFailure.of(method, drawn))
            else:
                answer.methods.append(MethodCurvesAnswer.of(method, drawn, drawing.with_acceleration))
        return answer


def _short(curve: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return numbers that are only drawn in the precision that a screen can show many times over."""
    return curve.astype(np.float32)
