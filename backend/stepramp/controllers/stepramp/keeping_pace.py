"""Keeping pace: whether a controller can prepare segments as fast as they are played; see docs/serial_protocol.md."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from stepramp.controllers.stepramp.ramp_image import AxisRamp, SegmentRamp
from stepramp.controllers.stepramp.speed_limits import Pace, SpeedLimits
from stepramp.units import ticks_from_us

SEGMENT_US, BUSY_SEGMENT_US = 350, 700
"""What a controller takes to prepare a segment of each axis that moves: at least, and where they take all of its
processor that they may [µs]; measured, see decision 10."""
SEGMENTS_IN_A_ROW = 8
"""So many may be ready beforehand."""


@dataclass(frozen=True)
class Preparation:
    """How fast a controller prepares the segments of axes that may all move at the same time."""

    axes: int
    share: float
    """Of the processor that they may take, at full speed; at most 1."""
    timer_hz: int

    @classmethod
    def of(cls, speeds: SpeedLimits, paces: Sequence[Pace]) -> "Preparation":
        """Return it for axes with these full speeds."""
        return cls(len(paces), min(float(speeds.share(paces)), 1.0), speeds.timer_hz)

    def keeps_pace_with(self, ramp: AxisRamp) -> bool:
        """Whether any segments of a ramp in a row last long enough, up and then down as in the shortest move of all.

        It has less time the faster they are, since the other axes are then as fast as well. A ramp that is computed
        while it is played has a limit of its speed that sees to it.
        """
        if not isinstance(ramp, SegmentRamp):
            return True
        segments = (*ramp.up, *reversed(ramp.down))
        if len(segments) < SEGMENTS_IN_A_ROW:
            return True
        first, count, add = np.array(segments, np.int64).T
        lasting = sliding_window_view(count * first + add * (count * (count - 1) // 2), SEGMENTS_IN_A_ROW).sum(1)
        shortest = sliding_window_view(np.minimum(first, first + add * (count - 1)), SEGMENTS_IN_A_ROW).min(1)
        segment_us = np.maximum(SEGMENT_US, BUSY_SEGMENT_US * self.share * ramp.slew_interval_ticks / shortest)
        row_us = SEGMENTS_IN_A_ROW * self.axes * segment_us
        return bool((lasting >= ticks_from_us(1, self.timer_hz) * row_us).all())
