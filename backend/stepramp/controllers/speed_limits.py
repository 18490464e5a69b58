"""How fast axes may be when several move at the same time: what a controller's processor can serve.

Each axis takes the time of its own step interrupts, and more when its ramp is computed while it is played; together
they may take all of the processor's, and no more.
"""

import math
from collections.abc import Collection
from dataclasses import dataclass
from typing import NamedTuple

from stepramp.controllers.messages import HelloReply
from stepramp.controllers.settings import Settings
from stepramp.units import MICROSECONDS_PER_SECOND

SHORTEST_GAUGE_INTERVAL = 3200
"""Of an axis with gauge outputs [fast ticks]."""
WHOLE = 1 + 1e-9
"""All of the processor: what is above it by rounding is not."""


class Pace(NamedTuple):
    """The most that an axis comes to."""

    interval: int
    """The shortest [fast ticks]."""
    by_formula: bool = False
    """Whether its ramp is computed while it is played."""


@dataclass(frozen=True)
class SpeedLimits:
    """What a controller can serve, with its settings. Intervals are fast ticks."""

    fast_clock_hz: int
    shortest_intervals: tuple[int, ...]
    shortest_line_intervals: tuple[int, ...]
    shortest_formula_interval: int
    settings: Settings

    @classmethod
    def of(cls, hello: HelloReply, settings: Settings) -> "SpeedLimits":
        """Return the limits of a controller, from its hello and its settings."""
        return cls(
            hello.fast_clock_hz,
            hello.shortest_intervals,
            hello.shortest_line_intervals,
            hello.shortest_formula_interval,
            settings,
        )

    def shortest_alone(self, *, by_formula: bool) -> int:
        """Return the shortest interval of an axis that moves alone [fast ticks]."""
        if self.settings.outputs == "gauges":
            return SHORTEST_GAUGE_INTERVAL
        return math.ceil(self._cycles(1, by_formula=by_formula))

    def share(self, paces: Collection[Pace]) -> float:
        """Return the part of the processor that axes take together."""
        if not paces:
            return 0.0
        if self.settings.outputs == "gauges":
            return max(SHORTEST_GAUGE_INTERVAL / pace.interval for pace in paces)
        return sum(self._cycles(len(paces), by_formula=pace.by_formula) / pace.interval for pace in paces)

    def line_share(self, axes: int, shortest: int) -> float:
        """Return the part of the processor that a line takes, from its leader's shortest interval."""
        if axes < 2:
            return self.share([Pace(shortest)])
        if self.settings.outputs == "gauges":
            return SHORTEST_GAUGE_INTERVAL / shortest
        return (self.shortest_line_intervals[axes - 2] + self._extra_cycles) / shortest

    def _cycles(self, axes: int, *, by_formula: bool) -> float:
        """Return what a step of one of so many axes takes."""
        own = self.shortest_formula_interval if by_formula else self.shortest_intervals[axes - 1] / axes
        return own + self._extra_cycles

    @property
    def _extra_cycles(self) -> float:
        return self.settings.pulse_width_us * self.fast_clock_hz / MICROSECONDS_PER_SECOND


def interval_ticks(speed_steps_per_s: float, timer_hz: int) -> int:
    """Return the interval of a speed in whole ticks, with its sign; 0 for no speed."""
    return round(timer_hz / speed_steps_per_s) if speed_steps_per_s else 0
