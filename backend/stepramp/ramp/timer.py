"""Ticks: how intervals become whole numbers of timer ticks, and what a timer can't do."""

import math
from dataclasses import dataclass

import numpy as np

from stepramp.design import Timer
from stepramp.ramp.move import Intervals, Ramp
from stepramp.units import speed_from_interval, ticks_from_us, us_from_ticks


@dataclass(frozen=True)
class Warning:
    """Something that works, but not as the design says; `field` is where it can be changed."""

    field: str | None
    message: str


def nearest(ramp: Ramp) -> Ramp:
    """Return the ramp in whole ticks, each interval rounded to the nearest, halves up."""
    return Ramp(up=_nearest(ramp.up), slew=math.floor(ramp.slew + 0.5), down=_nearest(ramp.down))


def _nearest(intervals: Intervals) -> Intervals:
    return np.floor(intervals.astype(np.float64) + 0.5).astype(np.int64)


def rescaled(ramp: Ramp, from_hz: float, to_hz: float) -> Ramp:
    """Return a ramp given in ticks of one timer [Hz] in whole ticks of another, each interval to the nearest."""
    factor = to_hz / from_hz
    return nearest(Ramp(up=ramp.up * factor, slew=ramp.slew * factor, down=ramp.down * factor))


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
                f"The shortest interval, {us_from_ticks(shortest, timer.frequency_hz):,.2f} µs, is less than the "
                f"{timer.shortest_interval_us:g} µs that the controller needs: "
                f"use a slew speed of at most {fastest:,.0f} steps/s.",
            )
        )
    return warnings
