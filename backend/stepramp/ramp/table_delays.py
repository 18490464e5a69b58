"""What a lookup table stands for: the delays of the steps that play each of its ramp indices."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepramp.design import Design
from stepramp.errors import Limits, Rejected, Rejection
from stepramp.methods import REFERENCE
from stepramp.numerics.limit_text import highest
from stepramp.numerics.ramp import RealRamp
from stepramp.ramp.plan import real_ramp
from stepramp.ramp.slopes import SIDES, too_long
from stepramp.units import us_from_ticks

WIDEST = 65535
"""Ramp indices and delays are of 16 bits."""
MOST_SIDE_STEPS = WIDEST - 2
"""Longest side of a ramp that a table stands for: its first step up is at ramp index 2."""

FitTo = Literal["played", "ramp_index"]
IntervalUnit = Literal["us", "ticks"]


@dataclass(frozen=True)
class RampDelays:
    """The delays of the steps that play successive ramp indices, from `first_index` on; in one unit."""

    first_index: int
    longest: NDArray[np.float64]
    """Of the slowest step that plays the index, shape (indices,)."""
    shortest: NDArray[np.float64]
    """Of the fastest, shape (indices,)."""


def ramp_delays(design: Design, interval_unit: IntervalUnit, fit_to: FitTo = "played") -> RampDelays:
    """Return the delays that a table for a design stands for, in the unit of the table.

    played: those of the design's ramp, up and down, where a table is played as `table_ramp` says.
    ramp_index: at ramp index k the interval of step k of the acceleration, for players that count so; at 0 that of the
    base speed, unless that is 0.

    A design whose own method is a table is fitted to the exact ramp. Raises Rejected as real_ramp does, when a ramp
    index would be wider than 16 bits, and when the slew interval is less
    than the one tick that delays in ticks have at least.
    """
    if interval_unit == "ticks":
        _refuse_less_than_a_tick(design)
    ramp = real_ramp(design.with_method(REFERENCE) if design.method.plays_table else design)
    _refuse_long_side(design, SIDES[0], ramp.up)
    if fit_to == "played":
        _refuse_long_side(design, SIDES[1], ramp.down)
        ticks = _played(ramp)
    else:
        ticks = _of_steps_up(ramp, design)
    units_per_tick = us_from_ticks(1, design.timer.frequency_hz) if interval_unit == "us" else 1.0
    return RampDelays(ticks.first_index, ticks.longest * units_per_tick, ticks.shortest * units_per_tick)


def _played(ramp: RealRamp) -> RampDelays:
    """Return what moves of all lengths play: step i up is at index i + 1, step i from the end at i - 1.

    That is so in long moves. In short ones up and down may meet elsewhere along the indices than along the ramp, but
    the steps between lie between the two of a long move. Only indices 0 and 1 have no step up there: a move of one or
    two steps plays them in place of its first step up, if that is the slower one.
    """
    top = max(ramp.up.size + 2, ramp.down.size)
    down, up = _extended(ramp.down, ramp.slew, top + 1), _extended(ramp.up, ramp.slew, top - 1)
    up = np.concatenate((np.maximum(up[0], down[:2]), up))
    return RampDelays(0, np.maximum(up, down), np.minimum(up, down))


def _of_steps_up(ramp: RealRamp, design: Design) -> RampDelays:
    base = design.ramp.base_speed_steps_per_s
    at_rest = [design.timer.frequency_hz / base] if base > 0 else []
    delays = np.concatenate((at_rest, ramp.up, [ramp.slew])).astype(np.float64)
    return RampDelays(0 if at_rest else 1, delays, delays)


def _extended(side: NDArray[np.floating], slew: float, size: int) -> NDArray[np.float64]:
    return np.concatenate((side, np.full(size - side.size, slew))).astype(np.float64)


def _refuse_long_side(design: Design, field: str, side: NDArray[np.floating]) -> None:
    if side.size > MOST_SIDE_STEPS:
        raise too_long(design, field, MOST_SIDE_STEPS, ", so that ramp indices fit in 16 bits")


def _refuse_less_than_a_tick(design: Design) -> None:
    # In µs there is no such limit: no speed is above one step a µs.
    slew, timer_hz = design.ramp.slew_speed_steps_per_s, design.timer.frequency_hz
    if slew > timer_hz:
        limits = Limits(highest=highest(timer_hz), unit="steps/s", note=" with this timer: a delay is 1 tick or more")
        raise Rejected([Rejection.outside("ramp.slew_speed_steps_per_s", slew, limits)])
