"""What the planning routes take and answer."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Annotated, Any, Literal, Self, get_args

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from stepramp.design import MOST_NAMES, MOST_STEPS, Design, MethodName
from stepramp.errors import Limits, Rejected, Rejection
from stepramp.http_api.answer import Answer, Numbers, WholeNumbers
from stepramp.http_api.columns import Table
from stepramp.http_api.error_items import TOLD, ErrorItem, ToldAnswer, error_items, in_body
from stepramp.methods import REFERENCE
from stepramp.methods.common.method import TuningReport
from stepramp.ramp.error_curves import ErrorCurves
from stepramp.ramp.profile import Profile
from stepramp.ramp.thinning import kept_steps
from stepramp.units import speed_from_interval
from stepramp.validation import Document, ListOf, Within, refuse

CurveName = Literal[
    "relative_error",
    "tick_error",
    "speed_error_steps_per_s",
    "time_error_s",
    "position_lag_steps",
    "implied_acceleration_steps_per_s2",
    "method_error_ticks",
    "arithmetic_error_ticks",
    "rounding_error_ticks",
    "compression_error_ticks",
]

CURVE_NAMES: tuple[CurveName, ...] = get_args(CurveName)

MostPoints = Annotated[
    Annotated[int, Within(10, MOST_STEPS, "points", ", or null for every step")] | None,
    Field(description="Thin the arrays to about so many steps that keep the curve's shape; null: every step"),
]


MOST_NUMBERS = 100_000_000
"""In the arrays of an answer: so many, of some 10 characters, fit into the memory of a small PC."""


def refuse_more_numbers(arrays: int, moves: Sequence[Design], max_points: int | None) -> None:
    """Refuse max_points, from within a validator, when so many arrays for each move would hold too many numbers."""
    lengths = [abs(design.move.steps) for design in moves]
    points = sum(length if max_points is None else min(length, max_points) for length in lengths)
    if arrays * points > MOST_NUMBERS:
        why = f": with so many curves and steps an answer would hold more than {MOST_NUMBERS:,} numbers"
        most = MOST_NUMBERS // (arrays * len(moves))
        refuse("max_points", max_points, Limits(10, most, "points", is_whole=True, note=why))


StepOfMove = Annotated[int, Within(1, MOST_STEPS, "steps", ", or null")] | None


class Stretch(Document):
    """Which steps of a design's move are wanted."""

    design: Design
    max_points: MostPoints = None
    first_step: StepOfMove = Field(
        None, description="First step that is wanted, counted from 1; null: the move's first [steps]"
    )
    last_step: StepOfMove = Field(None, description="Last step that is wanted; null: the move's last [steps]")

    @property
    def span(self) -> tuple[int, int]:
        """First and last step that are wanted, counted from 1."""
        return self.first_step or 1, self.last_step or abs(self.design.move.steps)

    @model_validator(mode="after")
    def _is_of_the_move(self) -> Self:
        steps = abs(self.design.move.steps)
        if (self.first_step or 1) > steps:
            refuse("first_step", self.first_step, Limits(1, steps, "steps", is_whole=True, note=", or null"))
        first, last = self.span
        if not first <= last <= steps:
            refuse("last_step", self.last_step, Limits(first, steps, "steps", is_whole=True, note=", or null"))
        return self


class ProfilePayload(Stretch):
    """A design whose move is to be planned."""


class ErrorsPayload(Stretch):
    """A design and the methods that are to be compared."""

    methods: Annotated[list[MethodName], ListOf("method names", most=MOST_NAMES)] = Field(
        description="Methods to compare, each with the design's arithmetic or else the one usual for it"
    )
    reference: MethodName = Field(REFERENCE, description="Method that they are compared with")
    curves: Annotated[list[CurveName], ListOf("curve names", most=MOST_NAMES)] = Field(
        default=["relative_error", "tick_error"], description="Curves wanted; the figures come in any case"
    )
    segment_bound_ticks: Annotated[int, Within(0, 10_000, "ticks", ", or null for no segments")] | None = Field(
        None,
        description="Judge the move as a controller plays it from segments that keep to this bound [ticks]; null: as "
        "it is planned",
    )

    @model_validator(mode="after")
    def _can_be_answered(self) -> Self:
        steps_and_curves = 1 + len(self.curves)
        refuse_more_numbers(len(self.methods) * steps_and_curves, [self.design], self.max_points)
        return self


class PhaseAnswer(Answer):
    """A phase of the move."""

    name: Literal["accelerate", "slew", "decelerate"]
    first_step: int = Field(description="First step, counted from 1 [steps]")
    last_step: int = Field(description="Last step, counted from 1 [steps]")


class SummaryAnswer(Answer):
    """The move in a few figures."""

    steps: int = Field(description="Length of the move [steps]")
    duration_s: float = Field(description="From pulse 1 to the end of the last interval [s]")
    peak_speed_steps_per_s: float = Field(description="Highest speed of an interval [steps/s]")
    accelerate_steps: int = Field(description="Steps of the acceleration [steps]")
    slew_steps: int = Field(description="Steps at slew speed [steps]")
    decelerate_steps: int = Field(description="Steps of the deceleration [steps]")
    ramp_steps: int = Field(description="Both sides of the pushed ramp; shorter moves are cut out of it [steps]")
    ramp_speed_steps_per_s: float = Field(description="Speed between the two sides of that ramp [steps/s]")
    is_lowered: bool = Field(description="Whether the ramp is made for this move, too short for the slew speed")

    @classmethod
    def of(cls, profile: Profile) -> Self:
        """Return the summary of a profile."""
        return cls(
            steps=profile.intervals_ticks.size,
            duration_s=profile.duration_s,
            peak_speed_steps_per_s=profile.peak_speed_steps_per_s,
            accelerate_steps=profile.steps_of("accelerate"),
            slew_steps=profile.steps_of("slew"),
            decelerate_steps=profile.steps_of("decelerate"),
            ramp_steps=profile.plan.ramp_steps,
            ramp_speed_steps_per_s=speed_from_interval(profile.plan.ramp.slew, profile.timer_hz),
            is_lowered=profile.is_lowered,
        )


class WarningAnswer(Answer):
    """Something that works, but not as the design says."""

    field: str | None = Field(description="Path of the field in the request's body where it can be changed")
    message: str = Field(description="What happens and what to change")
    told: list[ToldAnswer] = Field(description=TOLD)

    @classmethod
    def all_of(cls, profile: Profile) -> list[Self]:
        """Return the warnings of a profile, with the fields' paths in the body of a request with its design."""
        return [
            cls(field=warning.field and f"design.{warning.field}", message=warning.message, told=warning.told)
            for warning in profile.warnings
        ]


class SlewResolutionAnswer(Answer):
    """How finely the timer divides speeds at slew speed."""

    relative: float = Field(description="One tick as a part of the slew interval: 0.01 is 1 %")
    speed_below_steps_per_s: float = Field(description="Nearest speed of whole ticks, not above [steps/s]")
    speed_above_steps_per_s: float | None = Field(
        description="Nearest speed of whole ticks, not below; null when that would be less than a tick [steps/s]"
    )


class TuningAnswer(Answer):
    """What the method `tuned` found, and how much better it is than formulas (20), (22) and (23)."""

    coefficient_up: float = Field(description="c of p (1 + q + c q²) for the acceleration")
    coefficient_down: float = Field(description="c of p (1 + q + c q²) for the deceleration")
    largest_relative_error: dict[MethodName, float] = Field(
        description="By method, the largest relative error of an interval, without sign: 0.01 is 1 %"
    )
    time_error: dict[MethodName, float] = Field(
        description="By method, how much longer the ramp takes than the exact one: 0.01 is 1 %"
    )


class ProfileAnswer(Answer):
    """One planned move. Pulse 1 is at time 0; pulse i + 1 comes intervals_ticks of step i later."""

    step: WholeNumbers = Field(description="Which steps the arrays are of, counted from 1 [steps]")
    intervals_ticks: WholeNumbers = Field(description="Wait after the pulse of each step [ticks]")
    time_s: Numbers = Field(description="Instant of the pulse of each step [s]")
    position_steps: WholeNumbers = Field(description="Position after the pulse of each step [steps]")
    speed_steps_per_s: Numbers = Field(description="Speed of each interval, v = F / p (7) [steps/s]")
    phases: list[PhaseAnswer] = Field(description="Stretches of the move that have steps, in order of time")
    summary: SummaryAnswer
    slew_resolution: SlewResolutionAnswer
    tuning: TuningAnswer | None = Field(description="For the method `tuned`; null for others")
    warnings: list[WarningAnswer]

    @classmethod
    def of(cls, profile: Profile, tuning: TuningReport | None, request: ProfilePayload) -> Self:
        """Return a profile as an answer: the steps that are wanted of it."""
        kept = _kept(profile.intervals_ticks, profile, request)
        return cls(
            step=kept + 1,
            intervals_ticks=profile.intervals_ticks[kept],
            time_s=profile.time_s[kept],
            position_steps=profile.position_steps[kept],
            speed_steps_per_s=profile.speed_steps_per_s[kept],
            phases=profile.phases,
            summary=SummaryAnswer.of(profile),
            slew_resolution=profile.slew_resolution,
            tuning=tuning,
            warnings=WarningAnswer.all_of(profile),
        )

    @property
    def tables(self) -> Iterator[Table]:
        """Its columns."""
        names = ("step", "intervals_ticks", "time_s", "position_steps", "speed_steps_per_s")
        yield Table("", {name: np.asarray(getattr(self, name)) for name in names})


class ExtremeAnswer(Answer):
    """The value of a curve that is furthest from 0."""

    value: float
    step: int = Field(description="First step that has it, counted from 1 [steps]")


class ErrorFiguresAnswer(Answer):
    """One method's errors against the reference in a few figures."""

    largest_relative_error: ExtremeAnswer
    largest_tick_error: ExtremeAnswer = Field(description="[ticks]")
    rms_relative_error: float = Field(description="Root of the mean square of the relative errors")
    relative_error_at_ramp_end: float = Field(description="Relative error of the last step of the acceleration")
    peak_acceleration_steps_per_s2: ExtremeAnswer = Field(description="Implied acceleration furthest from 0 [steps/s²]")
    peak_ramp_acceleration_steps_per_s2: ExtremeAnswer = Field(
        description="The same before the intervals are rounded to ticks: what a finer timer would leave [steps/s²]"
    )
    time_difference_s: float = Field(description="How much longer than the reference the move takes [s]")
    landing_error_steps_per_s: float = Field(description="Speed of the last interval less the base speed [steps/s]")
    waiting_steps: int = Field(description="Steps at the end that wait at the last interval [steps]")


class ErrorCurvesAnswer(ErrorFiguresAnswer):
    """One method's errors against the reference. Curves that were not asked for are left out."""

    method: MethodName
    step: WholeNumbers = Field(description="Which steps the curves are of, counted from 1 [steps]")
    relative_error: Numbers | None = Field(
        None, description="Interval over reference interval, less 1: 0.01 is 1 % too long"
    )
    tick_error: Numbers | None = Field(None, description="Interval less reference interval [ticks]")
    speed_error_steps_per_s: Numbers | None = Field(None, description="Speed less reference speed [steps/s]")
    time_error_s: Numbers | None = Field(None, description="How much later each interval ends [s]")
    position_lag_steps: Numbers | None = Field(None, description="Steps that the reference is ahead [steps]")
    implied_acceleration_steps_per_s2: Numbers | None = Field(None, description="(v_i² - v_(i-1)²) / 2 [steps/s²]")
    method_error_ticks: Numbers | None = Field(None, description="Part of the method itself [ticks]")
    arithmetic_error_ticks: Numbers | None = Field(None, description="Part of the arithmetic [ticks]")
    rounding_error_ticks: Numbers | None = Field(None, description="Part of the rounding [ticks]")
    compression_error_ticks: Numbers | None = Field(None, description="Part of the segments [ticks]")

    @classmethod
    def of(cls, judged: ErrorCurves, request: ErrorsPayload) -> Self:
        """Return a method's error curves that are wanted."""
        kept, names = _kept(judged.relative_error, judged.profile, request), request.curves
        curves = {name: _curve(judged, name)[kept] for name in names}
        return cls(method=judged.method, step=kept + 1, **curves, **figures(judged))


class MethodFailure(Answer):
    """Why a method has no curves."""

    method: MethodName
    errors: list[ErrorItem]

    @classmethod
    def of(cls, method: MethodName, rejected: Rejected) -> Self:
        """Return what keeps a method from having curves."""
        return cls(method=method, errors=error_items(in_body(rejected)))


class ErrorsAnswer(Answer):
    """Errors of methods against a reference that is not rounded to ticks."""

    reference: MethodName
    methods: list[ErrorCurvesAnswer] = Field(description="In the order asked for, without those that failed")
    failures: list[MethodFailure] = Field(description="Methods that don't fit the design, and why")

    @classmethod
    def of(cls, judged: Iterable[tuple[MethodName, ErrorCurves | Rejected]], request: ErrorsPayload) -> Self:
        """Return the error curves that are wanted."""
        answer = cls(reference=request.reference, methods=[], failures=[])
        for method, each in judged:
            if isinstance(each, Rejected):
                answer.failures.append(MethodFailure.of(method, each))
            else:
                answer.methods.append(ErrorCurvesAnswer.of(each, request))
        return answer

    @property
    def tables(self) -> Iterator[Table]:
        """The columns of each method. Raises Rejected for methods without any: only JSON can tell why."""
        if self.failures:
            raise Rejected([_as_sent(item) for failure in self.failures for item in failure.errors])
        for each in self.methods:
            columns = {name: each.content[name] for name in ("step", *CURVE_NAMES) if name in each.content}
            yield Table(each.method, {name: np.asarray(column) for name, column in columns.items()})


class ExampleAnswer(Answer):
    """A design to start from."""

    title: str
    description: str
    design: Design


class ExamplesAnswer(Answer):
    """Designs to start from."""

    examples: list[ExampleAnswer]


class HealthAnswer(Answer):
    """The server works."""

    status: Literal["ok"]
    version: str


def figures(judged: ErrorCurves) -> dict[str, Any]:
    """Return the figures of a method's errors, by the names of ErrorFiguresAnswer."""
    return {
        "largest_relative_error": judged.largest_relative_error,
        "largest_tick_error": judged.largest_tick_error,
        "rms_relative_error": judged.rms_relative_error,
        "relative_error_at_ramp_end": judged.relative_error_at_ramp_end,
        "peak_acceleration_steps_per_s2": judged.peak_acceleration,
        "peak_ramp_acceleration_steps_per_s2": judged.peak_ramp_acceleration,
        "time_difference_s": judged.time_difference_s,
        "landing_error_steps_per_s": judged.landing_error_steps_per_s,
        "waiting_steps": judged.waiting_steps,
    }


def _curve(judged: ErrorCurves, name: CurveName) -> NDArray[np.float64]:
    """Return a curve by its name in the answer; a part of the error is named for its source."""
    part = name.removesuffix("_error_ticks")
    curve: NDArray[np.float64] = getattr(judged.parts, part) if part != name else getattr(judged, name)
    return curve


def _kept(values: NDArray[np.int64] | NDArray[np.float64], profile: Profile, request: Stretch) -> NDArray[np.int64]:
    return kept_steps(values, profile.phases, request.max_points or values.size, request.span)


def _as_sent(item: ErrorItem) -> Rejection:
    return Rejection(item.field or "methods", item.value, item.allowed or item.message)
