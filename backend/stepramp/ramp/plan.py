"""Plan: a design's ramp, before and after rounding, and how much of it the design's move takes."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stepramp.design import MOST_STEPS, Design
from stepramp.errors import Change, Choices, Limits, Rejected, Rejection
from stepramp.methods import METHODS
from stepramp.methods.common.method import TuningReport
from stepramp.methods.table import table_ramp
from stepramp.numerics.limit_text import highest
from stepramp.numerics.numbers import NUMBERS
from stepramp.numerics.ramp import Ramp, RealRamp
from stepramp.numerics.slope import Slope
from stepramp.ramp.move import play, split
from stepramp.ramp.slopes import constant_slopes_of, playable_slopes_of, slopes_of
from stepramp.ramp.timer import carried, rounded
from stepramp.units import ticks_from_us, us_from_ticks

LONGEST_INTERVAL_TICKS = 2**60
"""No interval that is meant is near it, and a move of several can still be counted in 64 bits."""


@dataclass(frozen=True)
class Plan:
    """A design's ramp and its share in the design's move of N steps."""

    real: RealRamp
    """As the method computes it [ticks, not rounded]."""
    ramp: Ramp
    """In whole ticks: what a controller is sent."""
    steps: int
    """N, without sign."""
    carries: bool
    """Whether remainders are carried through the whole move."""

    @property
    def ramp_steps(self) -> int:
        """Steps of both sides of the whole ramp [steps]."""
        return int(self.ramp.up.size + self.ramp.down.size)

    @cached_property
    def sides(self) -> tuple[int, int]:
        """How many intervals of the up and of the down list the move takes."""
        return split(self.ramp, self.steps)

    @cached_property
    def real_intervals(self) -> NDArray[np.float64]:
        """The move's intervals before rounding [ticks], shape (N,)."""
        return play(self.real, self.steps, self.sides).astype(np.float64, copy=False)

    @cached_property
    def intervals(self) -> NDArray[np.int64]:
        """The move's intervals in whole ticks, shape (N,)."""
        if self.carries:
            return carried(self.real_intervals)
        return play(self.ramp, self.steps, self.sides)


def plan_of(design: Design) -> Plan:
    """Return the plan of a design.

    Raises Rejected when the ramp is longer than 10,000,000 steps, does not fit the method, or has an interval that
    comes to 0 ticks.
    """
    real = real_ramp(design)
    plan = Plan(real, _rounded(design, real), abs(design.move.steps), design.method.rounding == "carry")
    _refuse_less_than_a_tick(design, plan.intervals)
    return plan


def real_ramp(design: Design) -> RealRamp:
    """Return the design's ramp as its method computes it, in ticks not yet rounded.

    Raises Rejected when the ramp is longer than 10,000,000 steps, or does not fit the method or its arithmetic.
    """
    method = design.method.numerics
    if method.sides is None:
        return _table(design)
    up, down = _slopes_for_the_method(design)
    sides = method.sides(design.method.arithmetic, design.method.tuned_for)
    # The slew interval is in the method's numbers too; integers have as many digits as it needs.
    number = NUMBERS.get(design.method.arithmetic, np.float64)
    ramp = RealRamp(up=sides.up(up), slew=float(number(up.slew_interval)), down=sides.down(down))
    _refuse_runaway(design, ramp)
    return ramp


def ramp_of(design: Design) -> Ramp:
    """Return the design's ramp in whole ticks of its timer: what a controller is sent.

    With rounding `carry` the remainders are carried along each side, in order of time; the slew interval, which a
    controller repeats, is rounded to the nearest tick. Raises Rejected as plan_of does, but for what only carrying
    through a whole move brings about: the move isn't planned.
    """
    return _rounded(design, real_ramp(design))


def computed_steps(design: Design) -> int:
    """Return how many steps are computed for a design: its move's, or its ramp's when that is longer."""
    return int(min(max(abs(design.move.steps), longest_side(design)), MOST_STEPS))


def longest_side(design: Design) -> float:
    """Return how long the longer side of a design's ramp is [steps, not whole]: of a table its last ramp index."""
    if design.method.plays_table and design.table is not None:
        return design.table.rows[-1][0]
    return max(slope.length for slope in slopes_of(design))


def tuning_report(design: Design) -> TuningReport | None:
    """Return what tuning does for a design whose method is tuned; None for others. Raises Rejected as real_ramp."""
    tuning = design.method.numerics.tuning
    return None if tuning is None else tuning(*_slopes_for_the_method(design), design.method.tuned_for)


def _slopes_for_the_method(design: Design) -> tuple[Slope, Slope]:
    """Return both slopes. Raises Rejected when the design's method or its arithmetic is for another shape only."""
    slopes, method = playable_slopes_of(design), design.method
    shaped = Change("ramp.shape.name", design.ramp.shape.name)
    if method.numerics.shape is not None and not all(isinstance(slope, method.numerics.shape) for slope in slopes):
        others = tuple(name for name, each in METHODS.items() if each.shape is None)
        raise Rejected([Rejection.of_choices("method.name", method.name, Choices(others, shaped))])
    if method.arithmetic == "fixed" and constant_slopes_of(design) is None:
        exact = tuple(each for each in method.numerics.arithmetics if each != "fixed")
        raise Rejected([Rejection.of_choices("method.arithmetic", method.arithmetic, Choices(exact, shaped))])
    return slopes


def _refuse_runaway(design: Design, ramp: RealRamp) -> None:
    """Refuse an arithmetic whose rounding errors have left nothing of an interval; those of float64 never do."""
    for side in (ramp.up, ramp.down):
        # Neither comparison holds for what is no number.
        if side.size and not (side.min() > 0 and side.max() < LONGEST_INTERVAL_TICKS):
            allowed = (
                f"float64 for this ramp: over {side.size:,} steps the rounding errors of {design.method.arithmetic} "
                "add up until an interval is no number"
            )
            raise Rejected([Rejection("method.arithmetic", design.method.arithmetic, allowed)])


def _rounded(design: Design, real: RealRamp) -> Ramp:
    """Return the ramp in whole ticks. Raises Rejected when an interval comes to 0 ticks."""
    ramp = rounded(real, design.method.rounding)
    if ramp.slew < 1:
        raise Rejected(_less_than_a_tick(design))
    _refuse_less_than_a_tick(design, ramp.up, ramp.down)
    return ramp


def _refuse_less_than_a_tick(design: Design, *lists: NDArray[Any]) -> None:
    for intervals in lists:
        if intervals.size and intervals.min() < 1:
            raise Rejected(_less_than_a_tick(design))


def _less_than_a_tick(design: Design) -> list[Rejection]:
    """Return what is to blame for an interval that comes to 0 ticks."""
    blamed = _short_rows(design) if design.method.plays_table else _fast_slew(design)
    # Next to one tick a method may come to a little less.
    nearest = "nearest: rounded down, an interval of about 1 tick comes to none"
    return blamed or [Rejection("method.rounding", design.method.rounding, nearest)]


def _fast_slew(design: Design) -> list[Rejection]:
    slew, timer_hz = design.ramp.slew_speed_steps_per_s, design.timer.frequency_hz
    limits = Limits(highest=highest(timer_hz), unit="steps/s", note=" with this timer: an interval is 1 tick or more")
    return [Rejection.outside("ramp.slew_speed_steps_per_s", slew, limits)] if slew > timer_hz else []


def _short_rows(design: Design) -> list[Rejection]:
    rows = design.table.rows if design.table else []
    least = 0.5 if design.method.rounding == "nearest" else 1
    tick_us = math.ceil(us_from_ticks(1, design.timer.frequency_hz))
    limits = Limits(lowest=tick_us, unit="µs", is_whole=True, note=": with this timer that is 1 tick or more")
    # Only delays in µs can be so short: in ticks they are whole.
    return [
        Rejection.outside(f"table.rows.{row}.1", delay, limits)
        for row, (_, delay) in enumerate(rows)
        if ticks_from_us(delay, design.timer.frequency_hz) < least
    ]


def _table(design: Design) -> RealRamp:
    table = design.table
    if table is None:
        needed = Choices.needed("a table", "method.name", design.method.name)
        raise Rejected([Rejection.of_choices("table", None, needed)])
    rows = np.array(table.rows, dtype=np.int64)
    delays = rows[:, 1].astype(np.float64)
    if table.interval_unit == "us":
        delays = delays * ticks_from_us(1, design.timer.frequency_hz)
    return table_ramp(rows[:, 0], delays)
