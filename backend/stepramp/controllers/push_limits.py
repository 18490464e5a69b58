"""What a controller can take of a design, with its settings, and how a design that is beyond it is told so."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from stepramp.controllers.course import Ways
from stepramp.controllers.messages import HelloReply
from stepramp.controllers.ramp_image import MOST_SEGMENTS, IntervalLimits
from stepramp.controllers.settings import Settings
from stepramp.controllers.speed_limits import Pace, SpeedLimits
from stepramp.design import Design
from stepramp.errors import Rejected, Rejection
from stepramp.ramp.move import Ramp
from stepramp.units import MICROSECONDS_PER_SECOND, speed_from_interval, us_from_ticks


@dataclass(frozen=True)
class PushLimits:
    """What a controller can take, in ticks of the clock that its ramps are to be played with."""

    fast_clock: bool
    timer_hz: int
    of_segments: range
    """Intervals of a ramp of segments [ticks]."""
    by_formula: range
    """Intervals of a ramp that is computed while it is played [ticks]."""
    most_segments: int
    """Of one ramp."""
    largest_image_bytes: int
    speeds: SpeedLimits

    @classmethod
    def of(cls, hello: HelloReply, settings: Settings, timer_hz: int) -> "PushLimits":
        """Return the limits of a controller that introduced itself like this, for one of its clocks [Hz]."""
        fast = timer_hz == hello.fast_clock_hz
        speeds, intervals = SpeedLimits.of(hello, settings), IntervalLimits.of(hello)
        segments, formula = intervals.of_segments(fast_clock=fast), intervals.by_formula(fast_clock=fast)
        of_segments, by_formula = (
            -(-speeds.shortest_alone(by_formula=computed) * timer_hz // hello.fast_clock_hz)
            for computed in (False, True)
        )
        return cls(
            fast_clock=fast,
            timer_hz=timer_hz,
            of_segments=range(max(segments.start, of_segments), segments.stop),
            by_formula=range(max(formula.start, by_formula), formula.stop),
            most_segments=min(hello.most_segments, MOST_SEGMENTS),
            largest_image_bytes=hello.largest_image_bytes,
            speeds=speeds,
        )

    def share(self, ways: Iterable[Ways]) -> float:
        """Return the part of the processor that axes take, all at the full speed of their ramps."""
        ratio = self.speeds.fast_clock_hz // self.timer_hz
        return self.speeds.share([Pace(each.slew_interval * ratio, each.by_formula) for each in ways])

    def check(self, design: Design, ramp: Ramp, path: str) -> None:
        """Reject a ramp that is too fast or too slow for the controller; what to change depends on the method."""
        limits, hz = self.of_segments, self.timer_hz
        shortest, longest = limits.start, limits.stop - 1
        intervals = np.concatenate((ramp.up, [ramp.slew], ramp.down))
        if shortest <= intervals.min() and intervals.max() <= longest:
            return
        if design.method.name == "table":
            raise Rejected(list(self._bad_rows(design, path)))
        if intervals.min() < shortest or ramp.slew > longest:
            slowest, fastest = speed_from_interval(longest, hz), speed_from_interval(shortest, hz)
            allowed = f"from {slowest:,.6g} to {fastest:,.10g} steps/s with this controller and its settings"
            field, value = "slew_speed_steps_per_s", design.ramp.slew_speed_steps_per_s
        else:
            most_us = us_from_ticks(longest, hz)
            allowed = f"more, so that each step takes at most {most_us:,.10g} µs: this controller's longest"
            field, value = "acceleration_steps_per_s2", design.ramp.acceleration_steps_per_s2
        raise Rejected([Rejection(f"{path}ramp.{field}", value, allowed)])

    def _bad_rows(self, design: Design, path: str) -> Iterator[Rejection]:
        """Yield the delays of a design's table that lie outside the limits."""
        rows, unit = (design.table.rows, design.table.interval_unit) if design.table else ([], "us")
        scale = 1.0 if unit == "ticks" else MICROSECONDS_PER_SECOND / self.timer_hz
        shortest, longest = self.of_segments.start * scale, (self.of_segments.stop - 1) * scale
        words = "µs" if unit == "us" else "ticks"
        for number, (_, delay) in enumerate(rows):
            if not shortest <= delay <= longest:
                allowed = f"a delay from {shortest:,.10g} to {longest:,.10g} {words} with this controller"
                yield Rejection(f"{path}table.rows.{number}.1", delay, allowed)
