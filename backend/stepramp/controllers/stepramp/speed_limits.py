"""How fast axes may be when several move at the same time: what a controller's processor can serve.

Each axis takes the time of its own step interrupts, and more when its ramp is computed while it is played; together
they may take all of the processor's, and no more. It is counted as controllers do: see docs/serial_protocol.md.
"""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import NamedTuple

from stepramp.controllers.stepramp.messages.session import HelloReply
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.units import MICROSECONDS_PER_SECOND, interval_from_speed

SHORTEST_GAUGE_INTERVAL = 3200
"""Of an axis with gauge outputs [fast ticks]."""
COUNTED_PARTS = 4096
"""An axis' share is counted in such parts of the processor, whole ones, rounded down."""
MOST_COUNTED = 2**14 - 1
"""Of one axis [parts]."""
LONGEST_COUNTED = 2**16 - 1
"""A longer interval counts as nothing [ticks]."""
NOTHING = Fraction()


class Pace(NamedTuple):
    """The most that an axis comes to."""

    interval: int
    """The shortest [ticks]."""
    by_formula: bool = False
    """Whether its ramp is computed while it is played."""
    line_axes: int = 1
    """Axes that make steps on the line that it leads."""


@dataclass(frozen=True)
class SpeedLimits:
    """What a controller can serve, with its settings, when it plays ramps in ticks of one of its clocks."""

    timer_hz: int
    fast_clock_hz: int
    shortest_intervals: tuple[int, ...]
    """Of axes that move at the same time [fast ticks], as those below."""
    shortest_line_intervals: tuple[int, ...]
    shortest_formula_interval: int
    settings: StepRampSettings

    @classmethod
    def of(cls, hello: HelloReply, settings: StepRampSettings, timer_hz: int) -> "SpeedLimits":
        """Return the limits of a controller, from its hello and its settings, for one of its clocks [Hz]."""
        return cls(
            timer_hz,
            hello.fast_clock_hz,
            hello.shortest_intervals,
            hello.shortest_line_intervals,
            hello.shortest_formula_interval,
            settings,
        )

    def shortest_alone(self, *, by_formula: bool) -> int:
        """Return the shortest interval of an axis that moves alone [ticks]."""
        return math.ceil(self._cycles(Pace(0, by_formula), 1) / self._fast_ticks_a_tick)

    def share(self, paces: Collection[Pace]) -> Fraction:
        """Return the part of the processor that axes take together, as controllers count it: 1 may not be exceeded."""
        return self._together([_counted(*each) for each in zip(paces, self._parts(paces), strict=True)])

    def slowed_down(self, paces: Sequence[Pace], least_share: Fraction) -> list[int]:
        """Return the intervals of axes [ticks] when all are as much slower as it takes for them to be served.

        least_share: what they take at least, as was counted or told by the controller.
        """
        share = max(self._together(self._parts(paces)), least_share)
        return [math.ceil(pace.interval * share) for pace in paces]

    def widest_pulse_us(self, paces: Collection[Pace]) -> int | None:
        """Return how wide pulses may be, at most as in the settings, for axes to be served; None: no width will do."""
        widths = range(self.settings.pulse_width_us, -1, -1)
        return next((width for width in widths if self._with_pulses(width).share(paces) <= 1), None)

    def or_narrower(self, paces: Collection[Pace]) -> str:
        """Return as the end of a message with which setting axes can be served as they are, if there is one."""
        used, widest = self.settings.pulse_width_us, self.widest_pulse_us(paces)
        return "" if widest in (None, used) else f", or with a pulse width of at most {widest} µs (now {used} µs)"

    def _with_pulses(self, width_us: int) -> "SpeedLimits":
        return replace(self, settings=self.settings.model_copy(update={"pulse_width_us": width_us}))

    def _together(self, parts: Sequence[Fraction]) -> Fraction:
        """Return what axes take together: gauges are slow, each has its limit whatever the others do."""
        return max(parts, default=NOTHING) if self.settings.outputs == "gauges" else sum(parts, NOTHING)

    def _parts(self, paces: Collection[Pace]) -> list[Fraction]:
        """Return the part of the processor that each axis takes."""
        return [self._cycles(pace, len(paces)) / (pace.interval * self._fast_ticks_a_tick) for pace in paces]

    def _cycles(self, pace: Pace, axes: int) -> Fraction:
        """Return what a step of one of so many axes takes."""
        if self.settings.outputs == "gauges":
            return Fraction(SHORTEST_GAUGE_INTERVAL)
        if pace.line_axes > 1:
            own = Fraction(self.shortest_line_intervals[pace.line_axes - 2])
        elif pace.by_formula:
            own = Fraction(self.shortest_formula_interval)
        else:
            own = Fraction(self.shortest_intervals[axes - 1], axes)
        return own + self._pulse_cycles

    @property
    def _pulse_cycles(self) -> int:
        """What a wide pulse takes more: it is waited for, and as much again is left for all else."""
        return self.settings.pulse_width_us * (self.fast_clock_hz // MICROSECONDS_PER_SECOND * 2)

    @property
    def _fast_ticks_a_tick(self) -> int:
        return self.fast_clock_hz // self.timer_hz


def _counted(pace: Pace, part: Fraction) -> Fraction:
    if pace.interval > LONGEST_COUNTED:
        return NOTHING
    return Fraction(min(int(part * COUNTED_PARTS), MOST_COUNTED), COUNTED_PARTS)


def interval_ticks(speed_steps_per_s: float, timer_hz: int) -> int:
    """Return the interval of a speed in whole ticks, with its sign; 0 for no speed."""
    if not speed_steps_per_s:
        return 0
    return int(math.copysign(interval_from_speed(abs(speed_steps_per_s), timer_hz), speed_steps_per_s))
