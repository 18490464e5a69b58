"""Ticks: how intervals become whole numbers of timer ticks, and what a timer can't do."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Rounding, Timer
from stepramp.ramp.move import Intervals, Ramp
from stepramp.units import speed_from_interval, ticks_from_us, us_from_ticks


@dataclass(frozen=True)
class Warning:
    """Something that works, but not as the design says; `field` is where it can be changed."""

    field: str | None
    message: str


def rounded(ramp: Ramp, rounding: Rounding) -> Ramp:
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


def carried(intervals: Intervals) -> NDArray[np.int64]:
    """Return intervals in whole ticks, rounded down, the remainder of each going into the next, shape (steps,)."""
    ends = np.floor(np.cumsum(intervals, dtype=np.float64)).astype(np.int64)
    return np.diff(ends, prepend=0)


def _nearest(intervals: Intervals) -> NDArray[np.int64]:
    return _floor(intervals.astype(np.float64) + 0.5)


def _floor(intervals: Intervals) -> NDArray[np.int64]:
    return np.floor(intervals).astype(np.int64)


def rescaled(ramp: Ramp, from_hz: float, to_hz: float) -> Ramp:
    """Return a ramp given in ticks of one timer [Hz] in whole ticks of another, each interval to the nearest."""
    factor = to_hz / from_hz
    return rounded(Ramp(up=ramp.up * factor, slew=ramp.slew * factor, down=ramp.down * factor), "nearest")


def timer_warnings(intervals: Intervals, timer: Timer) -> list[Warning]:
    """Return what the timer can't do of a move's intervals [ticks], shape (steps,)."""
    warnings = []
    longest, shortest = int(intervals.max()), int(intervals.min())
    widest = 2**timer.counter_bits - 1
    if longest > widest:
        bits = longest.bit_length()
        slower = timer.frequency_hz * widest / longest
        warnings.append(
            Warning(
                "timer.counter_bits",
                f"The longest interval, {longest:,} ticks, does not fit in a counter of {timer.counter_bits} bits "
                f"(at most {widest:,}): use {bits} bits, a timer of at most {slower:,.0f} Hz, or a higher base speed.",
            )
        )
    least = ticks_from_us(timer.shortest_interval_us, timer.frequency_hz)
    if shortest < least:
        fastest = speed_from_interval(least, timer.frequency_hz)
        warnings.append(
            Warning(
                "timer.shortest_interval_us",
                f"The shortest interval, {us_from_ticks(shortest, timer.frequency_hz):,.3g} µs, is less than the "
                f"{timer.shortest_interval_us:g} µs that the controller needs: "
                f"use a slew speed of at most {fastest:,.0f} steps/s.",
            )
        )
    return warnings
