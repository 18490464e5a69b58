"""The best lookup table for a ramp: rows of constant delay whose largest relative error is least.

Over steps of delays from p_max down to p_min, a row's delay y is off by y / p_min - 1 at most one way and
1 - y / p_max the other. Both are equal, and the larger of them least, at y = 2 p_max p_min / (p_max + p_min), where
they are (p_max - p_min) / (p_max + p_min). With whole delays it is one of the two whole numbers around y.

A ramp index that plays steps of different speeds is off by as much in any table. Where that is more than rows of
the same number could keep to elsewhere, it has a row of its own, and the others are as good as they get.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stepramp.design import MOST_TABLE_ROWS
from stepramp.errors import Limits, Rejected, Rejection
from stepramp.numerics.compiled import compiled
from stepramp.numerics.limit_text import lowest
from stepramp.ramp.table_delays import WIDEST, RampDelays

BYTES_PER_ROW = 4
"""Ramp index and delay, 16 bits each."""


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
class Floor:
    """What no number of rows can mend."""

    relative_error: float
    """The largest relative error of a table with a row for each ramp index."""
    ramp_index: int
    """The first index that has it."""


def floor_of(ramp: RampDelays) -> Floor:
    """Return the error that even a row for each ramp index has: delays are whole, and steps share an index."""
    _, errors = whole_delays(ramp.longest, ramp.shortest)
    worst = int(errors.argmax())
    return Floor(float(errors[worst]), ramp.first_index + worst)


def fit_rows(ramp: RampDelays, rows: int) -> FittedTable:
    """Return the table of at most so many rows whose largest relative error is least.

    A table for an error is made by letting each row reach as far as it can, which takes the fewest rows: a part of a
    row that is good enough is so too. The least error for which that gives few enough rows is found by halving.
    """
    low, high = 0.0, 1.0
    best = _reach(ramp.longest, ramp.shortest, high)
    while high - low > 1e-15 and (middle := (low + high) / 2) not in (low, high):
        tried = _reach(ramp.longest, ramp.shortest, middle)
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
    fitted = _table(ramp, _reach(ramp.longest, ramp.shortest, largest_relative_error))
    return reached(ramp, fitted, largest_relative_error, lambda: fit_rows(ramp, MOST_TABLE_ROWS))


def reached(
    ramp: RampDelays, fitted: FittedTable, largest_relative_error: float, best: Callable[[], FittedTable]
) -> FittedTable:
    """Return a fitted table that keeps to an error in at most 1,000 rows.

    Raises Rejected, with the error of the best table, when it doesn't.
    """
    if fitted.largest_relative_error > largest_relative_error * (1 + 1e-12) or len(fitted.rows) > MOST_TABLE_ROWS:
        note = f", the best that {MOST_TABLE_ROWS:,} rows of whole 16-bit delays can do here"
        if np.any(ramp.longest > ramp.shortest):
            note += ", where steps of different speeds play the same ramp index"
        limits = Limits(lowest(best().largest_relative_error, figures=3), note=note)
        raise Rejected([Rejection.outside("largest_relative_error", largest_relative_error, limits)])
    return fitted


def whole_delays(
    longest: NDArray[np.float64], shortest: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the best whole delays of 16 bits for delays from longest to shortest, and their errors, elementwise."""
    middle = 2 * longest * shortest / (longest + shortest)
    below, above = (np.clip(whole(middle), 1, WIDEST) for whole in (np.floor, np.ceil))
    below_error, above_error = (relative_errors(each, longest, shortest) for each in (below, above))
    is_below = below_error <= above_error
    return np.where(is_below, below, above).astype(np.int64), np.where(is_below, below_error, above_error)


def relative_errors(
    delays: NDArray[np.float64] | NDArray[np.int64], longest: NDArray[np.float64], shortest: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the larger of the relative errors of delays against the longest and the shortest that they stand for."""
    return np.maximum(delays / shortest - 1, 1 - delays / longest)


def _table(ramp: RampDelays, ends: NDArray[np.int64]) -> FittedTable:
    starts = np.concatenate(([0], ends[:-1]))
    longest, shortest = np.maximum.reduceat(ramp.longest, starts), np.minimum.reduceat(ramp.shortest, starts)
    delays, errors = whole_delays(longest, shortest)
    return FittedTable(np.stack((ramp.first_index + ends - 1, delays), axis=1), errors)


@compiled
def _reach(longest, shortest, error):  # type: ignore[no-untyped-def]  # compiled
    """Return one past the last index of each row when each row reaches as far as the error allows."""
    ends = np.empty(longest.size, np.int64)
    made, slow, fast = 0, longest[0], shortest[0]
    for i in range(longest.size):
        slow, fast = max(slow, longest[i]), min(fast, shortest[i])
        least = max(1.0, np.ceil(slow * (1 - error)))
        most = min(float(WIDEST), np.floor(fast * (1 + error)))
        if least > most and i > 0:
            ends[made] = i
            made += 1
            slow, fast = longest[i], shortest[i]
    ends[made] = longest.size
    return ends[: made + 1]
