"""What plots need of a design's move by several methods, in one go: errors against one reference, thinned together."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Design, MethodName
from stepramp.errors import Rejected, Rejection
from stepramp.ramp.error_curves import ErrorCurves, Parts, judged_against, reference_intervals
from stepramp.ramp.motion import Motion, motion_of
from stepramp.ramp.thinning import kept_steps_of_all


@dataclass(frozen=True)
class Drawn:
    """One method's move and the steps of it that are drawn."""

    judged: ErrorCurves
    kept: NDArray[np.int64]
    """Steps, counted from 0 and increasing, shape (M,)."""
    parts: Parts | None
    """Where the errors come from, when that is wanted."""
    motion: Motion | None
    """Acceleration and jerk as planned, when they are wanted."""

    @property
    def start_ticks(self) -> NDArray[np.int64]:
        """Instant of the pulse of each kept step [ticks], shape (M,)."""
        played = self.judged.played_ticks
        starts: NDArray[np.int64] = (np.cumsum(played) - played)[self.kept]
        return starts


@dataclass(frozen=True)
class Drawing:
    """What is to be drawn of a design."""

    design: Design
    chosen: tuple[MethodName, ...]
    reference: MethodName
    most_points: int
    span: tuple[int, int] | None = None
    """First and last step of the part that is looked at, counted from 1."""
    with_acceleration: bool = False
    with_parts: bool = False
    with_motion: bool = False
    segment_bound_ticks: int | None = None
    """Bound of the segments whose part in the error is wanted; everything else is as it is planned."""

    def methods(self) -> Iterator[tuple[MethodName, Drawn | Rejected]]:
        """Yield each wanted method with its curves, or with what keeps it from having any.

        Raises Rejected when the reference doesn't fit the design, and when the span lies outside the move.
        """
        self._check_span()
        reference_ticks = reference_intervals(self.design, self.reference)
        for method in self.chosen:
            try:
                drawn: Drawn | Rejected = self._drawn(method, reference_ticks)
            except Rejected as rejected:
                drawn = rejected
            yield method, drawn

    def _drawn(self, method: MethodName, reference_ticks: NDArray[np.float64]) -> Drawn:
        design = self.design.with_method(method)
        judged = judged_against(reference_ticks, design)
        parts = self._parts(judged) if self.with_parts else None
        curves: list[NDArray[np.int64] | NDArray[np.float64]] = [judged.played_ticks, judged.relative_error]
        if self.with_acceleration:
            curves.append(judged.implied_acceleration_steps_per_s2)
        if parts is not None:
            curves += vars(parts).values()
        motion = self._motion(judged) if self.with_motion else None
        if motion is not None:
            curves += vars(motion).values()
        kept = kept_steps_of_all(curves, judged.profile.phases, self.most_points, self.span)
        return Drawn(judged, kept, parts, motion)

    def _motion(self, planned: ErrorCurves) -> Motion:
        return motion_of(planned.precise_ticks, planned.timer_hz, planned.base_speed_steps_per_s)

    def _parts(self, planned: ErrorCurves) -> Parts:
        bound = self.segment_bound_ticks
        return (planned if bound is None else planned.played_from_segments(bound)).parts

    def _check_span(self) -> None:
        steps = abs(self.design.move.steps)
        if self.span is None:
            return
        first, last = self.span
        if first > steps:
            raise Rejected([Rejection("first_step", first, f"a step of the move, from 1 to {steps:,}")])
        if last < first or last > steps:
            raise Rejected([Rejection("last_step", last, f"a step of the move, from first_step to {steps:,}")])
