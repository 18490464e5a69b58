"""What a controller can take of a design, with its settings, and how a design that is beyond it is told so."""

import math
from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np

from stepramp.controllers.stepramp.messages.session import HelloReply
from stepramp.controllers.stepramp.ramp_image import MOST_SEGMENTS, IntervalLimits
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.controllers.stepramp.speed_limits import Pace, SpeedLimits
from stepramp.design import Design
from stepramp.errors import Limits, Rejected, Rejection
from stepramp.numerics.limit_text import highest, lowest
from stepramp.numerics.ramp import Ramp
from stepramp.ramp.playback.trajectory import Playback
from stepramp.units import MICROSECONDS_PER_SECOND, speed_from_interval, us_from_ticks


@dataclass(frozen=True)
class PushLimits:
    """What a controller can take, in ticks of the clock that its ramps are to be played with."""

    fast_clock: bool
    timer_hz: int
    of_segments: range
    """Intervals of a ramp of segments [ticks]."""
    by_formula: range
    """Intervals of a ramp that is computed while it is played [ticks]; none of a controller that computes none."""
    most_segments: int
    """Of one ramp."""
    largest_image_bytes: int
    speeds: SpeedLimits

    @classmethod
    def of(cls, hello: HelloReply, settings: StepRampSettings, timer_hz: int) -> "PushLimits":
        """Return the limits of a controller that introduced itself like this, for one of its clocks [Hz]."""
        fast = timer_hz == hello.fast_clock_hz
        speeds, intervals = SpeedLimits.of(hello, settings, timer_hz), IntervalLimits.of(hello)
        segments, formula = intervals.of_segments(fast_clock=fast), intervals.by_formula(fast_clock=fast)
        of_segments, by_formula = (speeds.shortest_alone(by_formula=computed) for computed in (False, True))
        return cls(
            fast_clock=fast,
            timer_hz=timer_hz,
            of_segments=range(max(segments.start, of_segments), segments.stop),
            by_formula=range(max(formula.start, by_formula), formula.stop if hello.computes_formulas else 0),
            most_segments=min(hello.most_segments, MOST_SEGMENTS),
            largest_image_bytes=hello.largest_image_bytes,
            speeds=speeds,
        )

    def too_fast_together(self, playbacks: Collection[Playback]) -> str | None:
        """Return what to say of axes that can't all move at the full speed of their ramps; None: they can."""
        paces = [Pace(each.slew_interval, each.by_formula) for each in playbacks]
        share = self.speeds.share(paces)
        if share <= 1:
            return None
        line = Pace(max(pace.interval for pace in paces), line_axes=len(paces))
        can_follow = self.speeds.settings.outputs != "gauges" and self.speeds.share([line]) <= 1
        return (
            f"At full speed all {len(paces)} axes together would take {math.ceil(100 * share)} % of the controller's "
            f"time: they can't all move at the same time{', except along a line' if can_follow else ''}"
            f"{self.speeds.or_narrower(paces)}."
        )

    def check(self, design: Design, ramp: Ramp, path: str) -> None:
        """Reject a ramp that is too fast or too slow for the controller; what to change depends on the method."""
        limits, hz = self.of_segments, self.timer_hz
        shortest, longest = limits.start, limits.stop - 1
        intervals = np.concatenate((ramp.up, [ramp.slew], ramp.down))
        if shortest <= intervals.min() and intervals.max() <= longest:
            return
        narrower = self.speeds.or_narrower([Pace(int(intervals.min()))])
        if design.method.plays_table:
            raise Rejected(list(self._bad_rows(design, path, narrower)))
        if intervals.min() < shortest or ramp.slew > longest:
            slowest, fastest = speed_from_interval(longest, hz), speed_from_interval(shortest, hz)
            note = f" with this controller and its settings{narrower}"
            speeds = Limits(lowest(slowest), highest(fastest, figures=10), "steps/s", note=note)
            slew = design.ramp.slew_speed_steps_per_s
            rejection = Rejection.outside(f"{path}ramp.slew_speed_steps_per_s", slew, speeds)
        else:
            most_us = us_from_ticks(longest, hz)
            allowed = f"more, so that each step takes at most {most_us:,.10g} µs: this controller's longest"
            rate = design.ramp.acceleration_steps_per_s2
            rejection = Rejection(f"{path}ramp.acceleration_steps_per_s2", rate, allowed)
        raise Rejected([rejection])

    def _bad_rows(self, design: Design, path: str, narrower: str) -> Iterator[Rejection]:
        """Yield the delays of a design's table that lie outside the limits."""
        rows, unit = (design.table.rows, design.table.interval_unit) if design.table else ([], "us")
        scale = 1.0 if unit == "ticks" else MICROSECONDS_PER_SECOND / self.timer_hz
        shortest, longest = self.of_segments.start * scale, (self.of_segments.stop - 1) * scale
        note = f" with this controller{narrower}"
        ends = math.ceil(shortest), math.floor(longest)
        delays = Limits(*ends, "µs" if unit == "us" else "ticks", is_whole=True, note=note)
        for number, (_, delay) in enumerate(rows):
            if not shortest <= delay <= longest:
                yield Rejection.outside(f"{path}table.rows.{number}.1", delay, delays)
