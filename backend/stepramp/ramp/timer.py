"""Ticks: how intervals become whole numbers of timer ticks."""

import math

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Rounding
from stepramp.numerics.ramp import Ramp, RealRamp


def rounded(ramp: RealRamp, rounding: Rounding) -> Ramp:
    """Return the ramp in whole ticks.

    nearest: each interval to the nearest, halves up. floor: down. carry: down along each side in order of time, the
    remainder going into the next interval; the slew interval to the nearest.
    """
    match rounding:
        case "nearest":
            return Ramp(up=_nearest(ramp.up), slew=math.floor(ramp.slew + 0.5), down=_nearest(ramp.down))
        case "floor":
            return Ramp(up=_floor(ramp.up), slew=math.floor(ramp.slew), down=_floor(ramp.down))
        case "carry":
            down = carried(ramp.down[::-1])[::-1]
            return Ramp(up=carried(ramp.up), slew=math.floor(ramp.slew + 0.5), down=down)


def carried(intervals: NDArray[np.floating]) -> NDArray[np.int64]:
    """Return intervals in whole ticks, rounded down, the remainder of each going into the next, shape (steps,)."""
    ends = np.floor(np.cumsum(intervals, dtype=np.float64)).astype(np.int64)
    return np.diff(ends, prepend=0)


def _nearest(intervals: NDArray[np.floating]) -> NDArray[np.int64]:
    return _floor(intervals.astype(np.float64) + 0.5)


def _floor(intervals: NDArray[np.floating]) -> NDArray[np.int64]:
    whole: NDArray[np.int64] = np.floor(intervals).astype(np.int64)
    return whole
