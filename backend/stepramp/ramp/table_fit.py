"""The best lookup table for a ramp: rows of constant delay whose largest relative error is least.

Over a stretch of delays from p_max down to p_min, a row's delay y is off by y / p_min - 1 at most one way and
1 - y / p_max the other. Both are equal, and the larger of them least, at y = 2 p_max p_min / (p_max + p_min), where
they are (p_max - p_min) / (p_max + p_min). With whole delays it is one of the two whole numbers around y.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepramp.design import MOST_TABLE_ROWS, Design
from stepramp.errors import Rejected, Rejection
from stepramp.ramp.compiled import compiled
from stepramp.ramp.plan import real_ramp
from stepramp.units import us_from_ticks

BYTES_PER_ROW = 4
"""Ramp index and delay, 16 bits each."""
WIDEST = 65535


@dataclass(frozen=True)
class FittedTable:
    """A lookup table and how far it is off."""

    rows: NDArray[np.int64]
    """Last ramp index [steps] and delay [unit of the delays], shape (rows, 2)."""
    relative_errors: NDArray[np.float64]
    """Largest relative error of each row, shape (rows,)."""

    @property
    def largest_relative_error(self) -> float:
        """The largest relative error of the table."""
        return float(self.relative_errors.max())


@dataclass(frozen=True)
class RampDelays:
    """The delays that a table stands for: of successive ramp indices from `first_index` on, shape (indices,)."""

    first_index: int
    delays: NDArray[np.float64]


def ramp_delays(design: Design, interval_unit: Literal["us", "ticks"]) -> RampDelays:
    """Return the delays of a design's acceleration by ramp index, in the unit of a table.

    At ramp index k it is the interval of step k, and after the last the slew interval; at 0, where a deceleration
    ends, that of the base speed, unless that is 0. A design whose own method is a table is fitted to the exact ramp.
    Raises Rejected as real_ramp does, and when a ramp index would be wider than 16 bits.
    """
    fitted = design.with_method("exact") if design.method.name == "table" else design
    ramp, base, timer_hz = real_ramp(fitted), design.ramp.base_speed_steps_per_s, design.timer.frequency_hz
    at_rest = [timer_hz / base] if base > 0 else []
    ticks = np.concatenate((at_rest, ramp.up, [ramp.slew])).astype(np.float64)
    if ramp.up.size >= WIDEST:
        acceleration, slew = design.ramp.acceleration_steps_per_s2, design.ramp.slew_speed_steps_per_s
        allowed = (
            f"at least {(slew**2 - base**2) / (2 * (WIDEST - 1)):,.6g} steps/s², so that ramp indices fit in 16 bits"
        )
        raise Rejected([Rejection("ramp.acceleration_steps_per_s2", acceleration, allowed)])
    unit = us_from_ticks(1, timer_hz) if interval_unit == "us" else 1.0
    return RampDelays(0 if at_rest else 1, ticks * unit)


def fit_rows(ramp: RampDelays, rows: int) -> FittedTable:
    """Return the table of at most so many rows whose largest relative error is least.

    A table for an error is made by letting each row reach as far as it can, which takes the fewest rows: a part of a
    row that is good enough is so too. The least error for which that gives few enough rows is found by halving.
    """
    low, high = 0.0, 1.0
    best = _reach(ramp.delays, high)
    while high - low > 1e-15 and (middle := (low + high) / 2) not in (low, high):
        tried = _reach(ramp.delays, middle)
        if tried.size <= rows:
            # What the rows are really off is at most the error allowed, and often less.
            best, high = tried, min(middle, _table(ramp, tried).largest_relative_error)
        else:
            low = middle
    return _table(ramp, best)


def fit_error(ramp: RampDelays, largest_relative_error: float) -> FittedTable:
    """Return the table of fewest rows none of whose delays is off by more than a relative error; see fit_rows.

    Raises Rejected when that takes finer delays than whole ones of 16 bits, or more than 1,000 rows.
    """
    fitted = _table(ramp, _reach(ramp.delays, largest_relative_error))
    return reached(fitted, largest_relative_error, lambda: fit_rows(ramp, MOST_TABLE_ROWS))


def reached(fitted: FittedTable, largest_relative_error: float, best: Callable[[], FittedTable]) -> FittedTable:
    """Return a fitted table that keeps to an error in at most 1,000 rows.

    Raises Rejected, with the error of the best table, when it doesn't.
    """
    if fitted.largest_relative_error > largest_relative_error * (1 + 1e-12) or len(fitted.rows) > MOST_TABLE_ROWS:
        least = best().largest_relative_error
        allowed = f"at least {least:.3g}, the best that {MOST_TABLE_ROWS:,} rows of whole 16-bit delays can do here"
        raise Rejected([Rejection("largest_relative_error", largest_relative_error, allowed)])
    return fitted


def _table(ramp: RampDelays, ends: NDArray[np.int64]) -> FittedTable:
    starts = np.concatenate(([0], ends[:-1]))
    longest = np.maximum.reduceat(ramp.delays, starts)
    shortest = np.minimum.reduceat(ramp.delays, starts)
    middle = 2 * longest * shortest / (longest + shortest)
    below = np.clip(np.floor(middle), 1, WIDEST)
    above = np.clip(np.ceil(middle), 1, WIDEST)

    def error(whole: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.maximum(whole / shortest - 1, 1 - whole / longest)

    chosen = np.where(error(below) <= error(above), below, above)
    rows = np.stack((ramp.first_index + ends - 1, chosen.astype(np.int64)), axis=1)
    return FittedTable(rows, error(chosen))


@compiled
def _reach(delays, error):  # type: ignore[no-untyped-def]  # compiled
    """Return one past the last delay of each row when each row reaches as far as the error allows."""
    ends = np.empty(delays.size, np.int64)
    made, longest, shortest = 0, delays[0], delays[0]
    for i in range(delays.size):
        longest, shortest = max(longest, delays[i]), min(shortest, delays[i])
        least = max(1.0, np.ceil(longest * (1 - error)))
        most = min(float(WIDEST), np.floor(shortest * (1 + error)))
        if least > most and i > 0:
            ends[made] = i
            made += 1
            longest = shortest = delays[i]
    ends[made] = delays.size
    return ends[: made + 1]
