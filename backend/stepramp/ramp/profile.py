"""Profile: the arrays of one planned move."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.design import MOST_STEPS, Design
from stepramp.errors import Rejected, Rejection
from stepramp.ramp import tuning
from stepramp.ramp.kinematics import Slope
from stepramp.ramp.methods import NUMBERS, sides_of
from stepramp.ramp.move import Intervals, Ramp, play, split
from stepramp.ramp.table import table_ramp
from stepramp.ramp.timer import carried, rounded
from stepramp.ramp.timer_limits import SlewResolution, Warning, slew_resolution, timer_warnings
from stepramp.units import speed_from_interval, ticks_from_us

MOST_TICKS = 2**62
"""Longest move [ticks]: its instants fit in 64 bits."""


@dataclass(frozen=True)
class Phase:
    """A stretch of a move, from its first step to its last, counted from 1."""

    name: str
    first_step: int
    last_step: int


@dataclass(frozen=True)
class Profile:
    """One planned move of N steps. Pulse 1 is at time 0; pulse i + 1 comes `intervals_ticks[i - 1]` after pulse i."""

    intervals_ticks: NDArray[np.int64]
    """Wait after each pulse [ticks], shape (N,)."""
    time_s: NDArray[np.float64]
    """Instant of each pulse [s], shape (N,)."""
    position_steps: NDArray[np.int64]
    """Position after each pulse [steps], shape (N,)."""
    speed_steps_per_s: NDArray[np.float64]
    """Speed of each interval, v = F / p (7) [steps/s], shape (N,)."""
    duration_s: float
    """From pulse 1 to the end of the last interval [s]."""
    phases: tuple[Phase, ...]
    """The stretches that have steps, in order of time."""
    slew_resolution: SlewResolution
    """How finely the timer divides speeds at slew speed."""
    warnings: tuple[Warning, ...]

    def steps_of(self, phase: str) -> int:
        """Return the number of steps of a phase, 0 when the move has none."""
        return sum(each.last_step - each.first_step + 1 for each in self.phases if each.name == phase)


def real_ramp(design: Design) -> Ramp:
    """Return the design's ramp as its method computes it, in ticks not yet rounded.

    Raises Rejected when the ramp is longer than 10,000,000 steps, or does not fit the method.
    """
    if design.method.name == "table":
        return _table(design)
    up = _slope(design, design.ramp.acceleration_steps_per_s2, "acceleration")
    down = _slope(design, design.ramp.slowdown_steps_per_s2, "deceleration")
    sides = sides_of(design.method)
    # The slew interval is in the method's numbers too; integers have as many digits as it needs.
    number = NUMBERS.get(design.method.arithmetic, np.float64)
    return Ramp(up=sides.up(up), slew=float(number(up.slew_interval)), down=sides.down(down))


def ramp_of(design: Design) -> Ramp:
    """Return the design's ramp in whole ticks of its timer: what a controller is sent.

    With rounding `carry` the remainders are carried along each side, in order of time; the slew interval, which a
    controller repeats, is rounded to the nearest tick. Raises Rejected as real_ramp does, and when an interval comes
    to 0 ticks.
    """
    ramp = rounded(real_ramp(design), design.method.rounding)
    for intervals in (ramp.up, np.array([ramp.slew]), ramp.down):
        _refuse_no_ticks(design, intervals)
    return ramp


def profile_of(design: Design) -> Profile:
    """Return the profile of the design's move.

    Raises Rejected as ramp_of does, and when the move takes more ticks than can be counted.
    """
    ramp, steps = ramp_of(design), abs(design.move.steps)
    intervals = _intervals(design, ramp, steps)
    slew_ticks = real_ramp(design).slew
    timer_hz = design.timer.frequency_hz
    if intervals.sum(dtype=np.float64) > MOST_TICKS:
        allowed = f"a lower frequency, so that the move takes at most {MOST_TICKS:,} ticks"
        raise Rejected([Rejection("timer.frequency_hz", timer_hz, allowed)])
    ends = np.cumsum(intervals)
    return Profile(
        intervals_ticks=intervals,
        time_s=np.concatenate(([0], ends[:-1])) / timer_hz,
        position_steps=np.arange(1, steps + 1) * int(math.copysign(1, design.move.steps)),
        speed_steps_per_s=timer_hz / intervals,
        duration_s=float(ends[-1]) / timer_hz,
        phases=_phases(ramp, steps),
        warnings=tuple(_short_move(design, ramp, steps) + timer_warnings(design, intervals, slew_ticks)),
        slew_resolution=slew_resolution(slew_ticks, timer_hz),
    )


def tuning_report(design: Design) -> tuning.TuningReport | None:
    """Return what tuning does for a design whose method is `tuned`; None for others. Raises Rejected as real_ramp."""
    if design.method.name != "tuned":
        return None
    up = _slope(design, design.ramp.acceleration_steps_per_s2, "acceleration")
    down = _slope(design, design.ramp.slowdown_steps_per_s2, "deceleration")
    return tuning.report(up, down, design.method.tuned_for)


def _intervals(design: Design, ramp: Ramp, steps: int) -> NDArray[np.int64]:
    """Return a move's intervals in whole ticks. A remainder that is carried goes through the whole move."""
    if design.method.rounding != "carry":
        return play(ramp, steps).astype(np.int64, copy=False)
    intervals = carried(play(real_ramp(design), steps, split(ramp, steps)))
    _refuse_no_ticks(design, intervals)
    return intervals


def _refuse_no_ticks(design: Design, intervals: Intervals) -> None:
    if intervals.size and intervals.min() < 1:
        fastest = f"at most {design.timer.frequency_hz:,.0f} steps/s with this timer: an interval is 1 tick or more"
        field, value = "ramp.slew_speed_steps_per_s", design.ramp.slew_speed_steps_per_s
        raise Rejected([Rejection(field, value, fastest)])


def _phases(ramp: Ramp, steps: int) -> tuple[Phase, ...]:
    n_up, n_down = split(ramp, steps)
    cuts = (("accelerate", 0, n_up), ("slew", n_up, steps - n_down), ("decelerate", steps - n_down, steps))
    return tuple(Phase(name, before + 1, last) for name, before, last in cuts if last > before)


def _short_move(design: Design, ramp: Ramp, steps: int) -> list[Warning]:
    needed = ramp.up.size + ramp.down.size
    if steps >= needed:
        return []
    peak = speed_from_interval(float(play(ramp, steps).min()), design.timer.frequency_hz)
    message = f"Too short to reach full speed, which takes {needed:,} steps: the move peaks at {peak:,.0f} steps/s."
    return [Warning("move.steps", message)]


def _slope(design: Design, acceleration: float, which: str) -> Slope:
    """Return one side's slope; a ramp that no move could play is refused before its arrays are made."""
    base, slew = design.ramp.base_speed_steps_per_s, design.ramp.slew_speed_steps_per_s
    slope = Slope(design.timer.frequency_hz, base, slew, acceleration)
    if slope.length > MOST_STEPS:
        least = (slew**2 - base**2) / (2 * MOST_STEPS)
        allowed = f"at least {least:,.6g} steps/s² between these speeds, for a ramp of at most {MOST_STEPS:,} steps"
        raise Rejected([Rejection(f"ramp.{which}_steps_per_s2", acceleration, allowed)])
    return slope


def _table(design: Design) -> Ramp:
    table = design.table
    if table is None:
        raise Rejected([Rejection("table", None, "a table, since method.name is 'table'")])
    rows = np.array(table.rows, dtype=np.int64)
    delays = rows[:, 1].astype(np.float64)
    if table.interval_unit == "us":
        delays = delays * ticks_from_us(1, design.timer.frequency_hz)
    return table_ramp(rows[:, 0], delays)
