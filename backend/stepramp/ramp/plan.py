"""Plan: a design's ramp, before and after rounding, and how much of it the design's move takes."""

from dataclasses import dataclass
from functools import cached_property

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
from stepramp.units import ticks_from_us


@dataclass(frozen=True)
class Plan:
    """A design's ramp and its share in the design's move of N steps."""

    real: Ramp
    """As the method computes it [ticks, not rounded]."""
    ramp: Ramp
    """In whole ticks: what a controller is sent."""
    steps: int
    """N, without sign."""
    carries: bool
    """Whether remainders are carried through the whole move."""

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
        return play(self.ramp, self.steps, self.sides).astype(np.int64, copy=False)


def plan_of(design: Design) -> Plan:
    """Return the plan of a design.

    Raises Rejected when the ramp is longer than 10,000,000 steps, does not fit the method, or has an interval that
    comes to 0 ticks.
    """
    real, carries = real_ramp(design), design.method.rounding == "carry"
    plan = Plan(real, rounded(real, design.method.rounding), abs(design.move.steps), carries)
    for intervals in (plan.ramp.up, np.array([plan.ramp.slew]), plan.ramp.down, plan.intervals):
        _refuse_no_ticks(design, intervals)
    return plan


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
    controller repeats, is rounded to the nearest tick. Raises Rejected as plan_of does.
    """
    return plan_of(design).ramp


def computed_steps(design: Design) -> int:
    """Return how many steps are computed for a design: its move's, or its ramp's when that is longer."""
    base, slew = design.ramp.base_speed_steps_per_s, design.ramp.slew_speed_steps_per_s
    accelerations = (design.ramp.acceleration_steps_per_s2, design.ramp.slowdown_steps_per_s2)
    slopes = (Slope(design.timer.frequency_hz, base, slew, acceleration) for acceleration in accelerations)
    return int(min(max(abs(design.move.steps), *(slope.length for slope in slopes)), MOST_STEPS))


def tuning_report(design: Design) -> tuning.TuningReport | None:
    """Return what tuning does for a design whose method is `tuned`; None for others. Raises Rejected as real_ramp."""
    if design.method.name != "tuned":
        return None
    up = _slope(design, design.ramp.acceleration_steps_per_s2, "acceleration")
    down = _slope(design, design.ramp.slowdown_steps_per_s2, "deceleration")
    return tuning.report(up, down, design.method.tuned_for)


def _refuse_no_ticks(design: Design, intervals: Intervals) -> None:
    if intervals.size and intervals.min() < 1:
        fastest = f"at most {design.timer.frequency_hz:,.0f} steps/s with this timer: an interval is 1 tick or more"
        field, value = "ramp.slew_speed_steps_per_s", design.ramp.slew_speed_steps_per_s
        raise Rejected([Rejection(field, value, fastest)])


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
