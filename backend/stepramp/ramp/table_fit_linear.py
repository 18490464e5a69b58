"""The best table of linear rows for a ramp: delays that fall by a whole number a step within each row.

As for rows of constant delay, each row reaches as far as an error allows, which takes the fewest rows, and the least
error for a number of rows is found by halving. For an error, every delay may lie between two whole numbers; a row of
a given slope fits as long as one first delay satisfies all of them. All whole slopes are tried: a wrong one soon ends.
"""

import numpy as np
from numpy.typing import NDArray

from stepramp.design import MOST_TABLE_ROWS
from stepramp.numerics.compiled import compiled
from stepramp.ramp.table_delays import WIDEST, RampDelays
from stepramp.ramp.table_fit import FittedTable, fit_rows, reached, relative_errors, whole_delays

BYTES_PER_LINEAR_ROW = 6
"""Ramp index, first delay and its change a step, 16 bits each."""
STEEPEST = 32767


def fit_linear_rows(ramp: RampDelays, rows: int) -> FittedTable:
    """Return the table of at most so many linear rows whose largest relative error is least.

    Its rows are (last ramp index [steps], delay at the row's first ramp index, what is added each step), in the unit of
    the delays; shape (rows, 3).
    """
    # A row of constant delay is a linear one, so their best is where to begin.
    constant = fit_rows(ramp, rows)
    best = FittedTable(np.pad(constant.rows, ((0, 0), (0, 1))), constant.relative_errors)
    finest = _table(ramp, _reached(ramp, 0.0))
    if len(finest.rows) <= rows and finest.largest_relative_error <= best.largest_relative_error:
        best = finest
    low, high = 0.0, best.largest_relative_error
    while high - low > 1e-12 and (middle := (low + high) / 2) not in (low, high):
        tried = _table(ramp, _reached(ramp, middle))
        if len(tried.rows) <= rows and tried.largest_relative_error <= best.largest_relative_error:
            best, high = tried, min(middle, tried.largest_relative_error)
        else:
            low = middle
    return best


def fit_linear_error(ramp: RampDelays, largest_relative_error: float) -> FittedTable:
    """Return the table of fewest linear rows none of whose delays is off by more than a relative error.

    Raises Rejected as table_fit.fit_error does.
    """
    fitted = _table(ramp, _reached(ramp, largest_relative_error))
    return reached(ramp, fitted, largest_relative_error, lambda: fit_linear_rows(ramp, MOST_TABLE_ROWS))


def _table(ramp: RampDelays, lines: NDArray[np.int64]) -> FittedTable:
    """Return the table of lines (one past the last index, first delay, add), shape (rows, 3)."""
    starts = np.concatenate(([0], lines[:-1, 0]))
    row = np.repeat(np.arange(len(lines)), lines[:, 0] - starts)
    fitted = lines[row, 1] + lines[row, 2] * (np.arange(ramp.longest.size) - starts[row])
    errors = np.maximum.reduceat(relative_errors(fitted, ramp.longest, ramp.shortest), starts)
    return FittedTable(lines + np.array([ramp.first_index - 1, 0, 0]), errors)


def _reached(ramp: RampDelays, error: float) -> NDArray[np.int64]:
    """Return (one past the last index, first delay, add) of each row when each reaches as far as the error allows."""
    lowest = np.maximum(1, np.ceil(ramp.longest * (1 - error))).astype(np.int64)
    highest = np.minimum(WIDEST, np.floor(ramp.shortest * (1 + error))).astype(np.int64)
    alone, _ = whole_delays(ramp.longest, ramp.shortest)
    lines: NDArray[np.int64] = _reach(lowest, highest, alone)
    return lines


@compiled
def _reach(lowest, highest, alone):  # type: ignore[no-untyped-def]  # compiled
    lines = np.empty((lowest.size, 3), np.int64)
    made, at = 0, 0
    while at < lowest.size:
        lines[made] = _furthest(lowest, highest, alone[at], at)
        at = lines[made, 0]
        made += 1
    return lines[:made]


@compiled
def _furthest(lowest, highest, alone, at):  # type: ignore[no-untyped-def]  # compiled
    """Return the line that reaches furthest from an index on; that index alone, with its own delay, if none does."""
    best = np.array([at + 1, alone, 0])
    if lowest[at] > highest[at] or at + 1 == lowest.size:
        return best
    flattest = min(highest[at + 1] - lowest[at], STEEPEST)
    for add in range(max(lowest[at + 1] - highest[at], -STEEPEST), flattest + 1):
        least, most, end = lowest[at], highest[at], at + 1
        while end < lowest.size:
            fallen = add * (end - at)
            next_least, next_most = max(least, lowest[end] - fallen), min(most, highest[end] - fallen)
            if next_least > next_most:
                break
            least, most, end = next_least, next_most, end + 1
        if end > best[0]:
            best[:] = (end, (least + most) // 2, add)
    return best
