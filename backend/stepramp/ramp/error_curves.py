"""How far a move's intervals lie from those of a reference, where that comes from, and what it does to the move."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Design, MethodName
from stepramp.errors import Rejected
from stepramp.numerics.compiled import compiled, counted
from stepramp.numerics.ramp import Ramp
from stepramp.ramp.move import play
from stepramp.ramp.plan import Plan, plan_of, real_ramp
from stepramp.ramp.profile import Profile, profile_of
from stepramp.ramp.segments import compress_sides, expand

Curve = NDArray[np.float64]


@dataclass(frozen=True)
class Extreme:
    """The value of a curve that is furthest from 0, and the first step that has it, counted from 1."""

    value: float
    step: int


@dataclass(frozen=True)
class Parts:
    """Where the error of each interval comes from [ticks], each of shape (N,); together they are the whole error."""

    method: Curve
    """The method in float64 less the reference: what the formula itself gets wrong."""
    arithmetic: Curve
    """The method in the design's arithmetic less the same in float64."""
    rounding: Curve
    """Whole ticks less the intervals before rounding."""
    compression: Curve
    """As a controller plays it from segments less whole ticks; 0 without a bound for the segments."""


@dataclass(frozen=True)
class ErrorCurves:
    """One method's move against a reference that is not rounded, step by step: arrays of shape (N,)."""

    method: MethodName
    profile: Profile
    """The method's own profile of the move."""
    played_ticks: NDArray[np.int64]
    """The intervals that are judged: the profile's, or those that its segments give [ticks]."""
    reference_ticks: Curve
    """The reference's intervals [ticks]."""
    design: Design
    """With the method that is judged."""
    timer_hz: float
    base_speed_steps_per_s: float

    def played_from_segments(self, bound_ticks: int) -> "ErrorCurves":
        """Return the errors of the same move as a controller plays it whose segments keep to that bound [ticks]."""
        return replace(self, played_ticks=_from_segments(self.profile.plan, bound_ticks))

    @cached_property
    def precise_ticks(self) -> Curve:
        """The method's intervals in float64 before rounding [ticks]."""
        return _precise(self.design, self.profile.plan)

    @cached_property
    def parts(self) -> Parts:
        """Where the errors come from [ticks]."""
        computed = self.profile.plan.real_intervals
        return Parts(
            method=self.precise_ticks - self.reference_ticks,
            arithmetic=computed - self.precise_ticks,
            rounding=self.profile.intervals_ticks - computed,
            compression=(self.played_ticks - self.profile.intervals_ticks).astype(np.float64),
        )

    @cached_property
    def tick_error(self) -> Curve:
        """p_i - reference_i [ticks]."""
        return self.played_ticks - self.reference_ticks

    @cached_property
    def relative_error(self) -> Curve:
        """p_i / reference_i - 1: 0.01 is an interval 1 % too long."""
        return relative_errors(self.played_ticks, self.reference_ticks)

    @cached_property
    def speed_error_steps_per_s(self) -> Curve:
        """F / p_i - F / reference_i, by (7) [steps/s]."""
        return self.timer_hz / self.played_ticks - self.timer_hz / self.reference_ticks

    @cached_property
    def time_error_s(self) -> Curve:
        """How much later than the reference each step's interval ends: the errors so far, added up [s]."""
        return np.cumsum(self.tick_error) / self.timer_hz

    @cached_property
    def position_lag_steps(self) -> Curve:
        """Steps that the reference is ahead at the end of each interval; between its steps in proportion [steps]."""
        ends, reference_ends = np.cumsum(self.played_ticks), np.cumsum(self.reference_ticks)
        steps = counted(1, ends.size)
        return np.interp(ends, np.concatenate(([0], reference_ends)), np.concatenate(([0], steps))) - steps

    @cached_property
    def implied_acceleration_steps_per_s2(self) -> Curve:
        """(v_i² - v_(i-1)²) / 2: the acceleration between two intervals, by (6); the first from the base speed."""
        squares = (self.timer_hz / self.played_ticks) ** 2
        return np.diff(squares, prepend=self.base_speed_steps_per_s**2) / 2

    @cached_property
    def _figures(self) -> "_Figures":
        # In one pass: over millions of steps it is memory that takes the time.
        return _figures_of(self.played_ticks, self.reference_ticks, self.timer_hz, self.base_speed_steps_per_s)

    @property
    def largest_relative_error(self) -> Extreme:
        """The relative error furthest from 0."""
        return self._figures.relative

    @property
    def largest_tick_error(self) -> Extreme:
        """The tick error furthest from 0 [ticks]."""
        return self._figures.tick

    @property
    def rms_relative_error(self) -> float:
        """The root of the mean square of the relative errors."""
        return math.sqrt(self._figures.sum_of_squares / self.played_ticks.size)

    @property
    def relative_error_at_ramp_end(self) -> float:
        """The relative error of the last step of the acceleration; of the first step when there is none."""
        last = max(self.profile.steps_of("accelerate"), 1) - 1
        return float(self.played_ticks[last] / self.reference_ticks[last] - 1)

    @property
    def peak_acceleration(self) -> Extreme:
        """The implied acceleration furthest from 0 after the first interval [steps/s²]."""
        return self._figures.acceleration

    @cached_property
    def peak_ramp_acceleration(self) -> Extreme:
        """The same before any rounding to ticks, or to integers by the arithmetic: the ramp's own [steps/s²]."""
        plan, (n_up, n_down) = self.profile.plan, self.profile.plan.sides
        is_fixed = self.design.method.arithmetic == "fixed"
        real = real_ramp(self.design.with_method(self.method, "float64")) if is_fixed else plan.real
        down = real.down[:n_down][::-1]
        value, step = _peak_acceleration(
            real.up[:n_up], real.slew, plan.steps - n_up - n_down, down, self.timer_hz, self.base_speed_steps_per_s
        )
        return Extreme(float(value), int(step))

    @property
    def time_difference_s(self) -> float:
        """How much longer than the reference the whole move takes [s]."""
        return self._figures.sum_of_ticks / self.timer_hz

    @property
    def landing_error_steps_per_s(self) -> float:
        """The speed of the last interval less the base speed [steps/s]."""
        return float(self.timer_hz / self.played_ticks[-1] - self.base_speed_steps_per_s)

    @property
    def waiting_steps(self) -> int:
        """Steps at the end, beyond the first, that all run at the last interval: a deceleration that ended early."""
        level = self.played_ticks[::-1] == self.played_ticks[-1]
        same = self.played_ticks.size if level.all() else int(np.argmin(level))
        return min(same, max(self.profile.steps_of("decelerate"), 1)) - 1


def error_curves(
    design: Design, method: MethodName, reference: MethodName, segment_bound_ticks: int | None = None
) -> ErrorCurves:
    """Return the errors of the design's move by one method against another, step by step.

    With segment_bound_ticks, the move is judged as a controller plays it whose segments keep to that bound [ticks].
    Raises Rejected when the design does not fit one of the methods.
    """
    return judged_against(reference_intervals(design, reference), design.with_method(method), segment_bound_ticks)


def all_error_curves(
    design: Design, methods: Sequence[MethodName], reference: MethodName, segment_bound_ticks: int | None = None
) -> Iterator[tuple[MethodName, ErrorCurves | Rejected]]:
    """Yield methods with the errors of the design's move by each, or with what keeps it from having any.

    Raises Rejected when the design does not fit the reference; see error_curves.
    """
    reference_ticks = reference_intervals(design, reference)
    for method in methods:
        try:
            judged: ErrorCurves | Rejected = judged_against(
                reference_ticks, design.with_method(method), segment_bound_ticks
            )
        except Rejected as rejected:
            judged = rejected
        yield method, judged


def reference_intervals(design: Design, reference: MethodName) -> Curve:
    """Return the intervals of the design's move by a method in float64, not rounded [ticks], shape (N,).

    Raises Rejected when the design does not fit the method.
    """
    return plan_of(design.with_method(reference, "float64")).real_intervals


def relative_errors(intervals: NDArray[np.int64] | Curve, reference: Curve) -> Curve:
    """Return intervals / reference - 1, shape (N,)."""
    out = np.empty(reference.size)
    _relative_errors(intervals, reference, out)
    return out


@compiled
def _relative_errors(intervals, reference, out):  # type: ignore[no-untyped-def]  # compiled
    # In one pass: over millions of steps it is memory that takes the time.
    for i in range(out.size):
        out[i] = intervals[i] / reference[i] - 1.0


def judged_against(reference_ticks: Curve, design: Design, segment_bound_ticks: int | None = None) -> ErrorCurves:
    """Return the errors of a design's move by its own method against intervals of its length; see error_curves."""
    profile = profile_of(design)
    planned = ErrorCurves(
        method=design.method.name,
        profile=profile,
        played_ticks=profile.intervals_ticks,
        reference_ticks=reference_ticks,
        design=design,
        timer_hz=design.timer.frequency_hz,
        base_speed_steps_per_s=design.ramp.base_speed_steps_per_s,
    )
    return planned if segment_bound_ticks is None else planned.played_from_segments(segment_bound_ticks)


def _precise(design: Design, plan: Plan) -> Curve:
    """Return the move's intervals by its method in float64, before rounding [ticks], shape (N,)."""
    if design.method.arithmetic == "float64":
        return plan.real_intervals
    precise = real_ramp(design.with_method(design.method.name, "float64"))
    return play(precise, plan.steps, plan.sides).astype(np.float64, copy=False)


def _from_segments(plan: Plan, bound_ticks: int) -> NDArray[np.int64]:
    """Return the move's intervals as segments give them [ticks], shape (N,)."""
    up, down = map(expand, compress_sides(plan.ramp, bound_ticks))
    return play(Ramp(up, plan.ramp.slew, down), plan.steps)


class _Figures(NamedTuple):
    """What one pass over a move's intervals finds."""

    relative: Extreme
    tick: Extreme
    acceleration: Extreme
    sum_of_squares: float
    """Of the relative errors."""
    sum_of_ticks: float
    """Of the tick errors."""


def _figures_of(played: NDArray[np.int64], reference: Curve, timer_hz: float, base_speed: float) -> _Figures:
    values, steps = np.empty(3), np.empty(3, np.int64)
    sums = _scan(played, reference, timer_hz, base_speed, values, steps)
    relative, tick, acceleration = (Extreme(float(values[i]), int(steps[i])) for i in range(3))
    return _Figures(relative, tick, acceleration, *sums)


@compiled
def _peak_acceleration(up, slew, slew_steps, down, timer_hz, base_speed):  # type: ignore[no-untyped-def]  # compiled
    """Return the implied acceleration furthest from 0 of a move, and its step; within the slew phase there is none."""
    found, at = 0.0, 1
    before = base_speed * base_speed
    slew_end = up.size + slew_steps
    i = 0
    while i < slew_end + down.size:
        # One slew interval after another changes nothing, but the second interval always counts: see below.
        if up.size + 1 < i < slew_end and i > 1:
            i = slew_end
            continue
        interval = up[i] if i < up.size else slew if i < slew_end else down[i - slew_end]
        speed = timer_hz / interval
        acceleration = (speed * speed - before) / 2
        before = speed * speed
        # The first interval's counts only when there is no other.
        if i <= 1 or abs(acceleration) > abs(found):
            found, at = acceleration, i + 1
        i += 1
    return found, at


@compiled
def _scan(played, reference, timer_hz, base_speed, values, steps):  # type: ignore[no-untyped-def]  # compiled
    """Find the extremes of relative error, tick error and implied acceleration; return the sums of _Figures."""
    sum_of_squares = sum_of_ticks = 0.0
    before = base_speed * base_speed
    values[:] = 0.0
    steps[:] = 1
    for i in range(played.size):
        ticks = played[i] - reference[i]
        relative = played[i] / reference[i] - 1.0
        speed = timer_hz / played[i]
        acceleration = (speed * speed - before) / 2
        before = speed * speed
        sum_of_squares += relative * relative
        sum_of_ticks += ticks
        if abs(relative) > abs(values[0]):
            values[0], steps[0] = relative, i + 1
        if abs(ticks) > abs(values[1]):
            values[1], steps[1] = ticks, i + 1
        # The first interval's counts only when there is no other.
        if i == 1 or abs(acceleration) > abs(values[2]):
            values[2], steps[2] = acceleration, i + 1
    return sum_of_squares, sum_of_ticks
