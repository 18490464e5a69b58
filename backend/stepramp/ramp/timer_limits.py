"""What a timer can't do of a ramp, and what to change."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Design, Timer
from stepramp.errors import Told
from stepramp.numerics.limit_text import at_least, at_most, told_highest
from stepramp.units import speed_from_interval, ticks_from_us, us_from_ticks

COARSE = 0.01
"""Resolution at slew speed above which people are warned."""


@dataclass(frozen=True)
class TimerWarning:
    """Something that works, but not as the design says; `field` is where it can be changed."""

    field: str | None
    message: str
    told: tuple[Told, ...] = ()
    """The quantities of the message, in their order."""


@dataclass(frozen=True)
class SlewResolution:
    """How finely the timer divides speeds near an interval."""

    relative: float
    """One tick as a part of the interval: 0.01 is 1 %."""
    speed_below_steps_per_s: float
    """The nearest speed of whole ticks that is not above the one asked for [steps/s]."""
    speed_above_steps_per_s: float | None
    """The nearest speed of whole ticks that is not below the one asked for; None when that is no tick [steps/s]."""


def slew_resolution(interval_ticks: float, timer_hz: float) -> SlewResolution:
    """Return how finely a timer [Hz] divides speeds near an interval that is not yet rounded [ticks]."""
    shorter = math.floor(interval_ticks)
    return SlewResolution(
        relative=1 / interval_ticks,
        speed_below_steps_per_s=speed_from_interval(math.ceil(interval_ticks), timer_hz),
        speed_above_steps_per_s=speed_from_interval(shorter, timer_hz) if shorter else None,
    )


def timer_warnings(design: Design, intervals: NDArray[np.int64], slew_interval_ticks: float) -> list[TimerWarning]:
    """Return what the design's timer can't do of a move's intervals [ticks], shape (steps,).

    slew_interval_ticks: the slew interval before rounding [ticks].
    """
    longest, shortest = int(intervals.max()), int(intervals.min())
    found = (
        _wider_than_counter(longest, design.timer),
        _shorter_than_shortest(shortest, design.timer),
        _coarse_slew(slew_interval_ticks, design.timer),
    )
    return [warning for warning in found if warning is not None]


def _wider_than_counter(longest: int, timer: Timer) -> TimerWarning | None:
    widest = 2**timer.counter_bits - 1
    if longest <= widest:
        return None
    slower = timer.frequency_hz * widest / longest
    return TimerWarning(
        "timer.counter_bits",
        f"The longest interval, {longest:,} ticks, does not fit in a counter of {timer.counter_bits} bits "
        f"(at most {widest:,}): use {longest.bit_length()} bits, a timer of {at_most(slower)} Hz, "
        "or a higher base speed.",
    )


def _shorter_than_shortest(shortest: int, timer: Timer) -> TimerWarning | None:
    least = ticks_from_us(timer.shortest_interval_us, timer.frequency_hz)
    if shortest >= least:
        return None
    fastest = told_highest(speed_from_interval(math.ceil(least), timer.frequency_hz), "steps/s")
    return TimerWarning(
        "timer.shortest_interval_us",
        f"The shortest interval, {us_from_ticks(shortest, timer.frequency_hz):,.2f} µs, is less than the "
        f"{timer.shortest_interval_us:,g} µs that the controller needs: "
        f"use a slew speed of at most {fastest}.",
        (fastest,),
    )


def _coarse_slew(slew_interval_ticks: float, timer: Timer) -> TimerWarning | None:
    resolution = slew_resolution(slew_interval_ticks, timer.frequency_hz)
    if resolution.relative <= COARSE:
        return None
    below, above = resolution.speed_below_steps_per_s, resolution.speed_above_steps_per_s
    finer = timer.frequency_hz * resolution.relative / COARSE
    advice = f"a timer of {at_least(finer)} Hz has a resolution of {100 * COARSE:g} %."
    if below == above:
        told: tuple[Told, ...] = ()
        text = f"Speeds near the slew speed are {100 * resolution.relative:.1f} % apart; {advice}"
    else:
        told = tuple(Told(f"{speed:,.0f} steps/s", speed, "steps/s") for speed in (below, above) if speed)
        text = (
            f"One tick is {100 * resolution.relative:.1f} % of the slew interval: the nearest speeds are "
            f"{' and '.join(map(str, told))}. Use one of them; {advice}"
        )
    return TimerWarning("timer.frequency_hz", text, told)
