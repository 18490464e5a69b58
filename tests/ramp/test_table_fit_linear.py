import itertools
import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from stepramp.errors import Rejected
from stepramp.ramp.table_delays import RampDelays
from stepramp.ramp.table_fit import FittedTable, fit_rows
from stepramp.ramp.table_fit_linear import fit_linear_error, fit_linear_rows

delay_lists = st.lists(st.floats(3, 14), min_size=1, max_size=5).map(lambda delays: sorted(delays, reverse=True))


def of_steps(first_index: int, delays: object) -> RampDelays:
    """Return what a table stands for where each ramp index plays one step."""
    return RampDelays(first_index, np.array(delays), np.array(delays))


def least_error(delays: list[float], rows: int) -> float:
    """Try every way to cut the delays into rows, and every whole line of a row."""
    span = math.ceil(2 * max(delays))

    def best_line(part: list[float]) -> float:
        lines = ([first + add * n for n in range(len(part))] for first in range(1, span) for add in range(-span, span))
        return min(max(abs(a / b - 1) for a, b in zip(line, part, strict=True)) for line in lines if min(line) >= 1)

    count = len(delays)
    cost = {(a, b): best_line(delays[a:b]) for a in range(count) for b in range(a + 1, count + 1)}
    cuts = (cut for size in range(min(rows, count)) for cut in itertools.combinations(range(1, count), size))
    return min(max(cost[pair] for pair in itertools.pairwise((0, *cut, count))) for cut in cuts)


def played(table: FittedTable, first_index: int) -> np.ndarray:
    delays, start = [], first_index
    for last, delay, add in table.rows.tolist():
        delays += [delay + add * n for n in range(last - start + 1)]
        start = last + 1
    return np.array(delays)


@settings(max_examples=25)
@given(delay_lists, st.integers(1, 4))
def test_no_table_of_as_many_linear_rows_is_better(delays: list[float], rows: int) -> None:
    fitted = fit_linear_rows(of_steps(1, delays), rows)
    assert len(fitted.rows) <= rows
    assert fitted.largest_relative_error == pytest.approx(least_error(delays, rows), abs=1e-9)


@settings(max_examples=400)
@example([28724.0, 28723.5], 1)
@given(st.lists(st.floats(2, 70_000), min_size=1, max_size=40), st.integers(1, 12))
def test_linear_rows_are_never_worse_and_have_the_error_they_state(delays: list[float], rows: int) -> None:
    ramp = of_steps(3, delays)
    fitted = fit_linear_rows(ramp, rows)
    assert len(fitted.rows) <= rows
    assert fitted.largest_relative_error <= fit_rows(ramp, rows).largest_relative_error + 1e-9
    error = np.abs(played(fitted, 3) / ramp.longest - 1)
    assert fitted.largest_relative_error == pytest.approx(error.max(), abs=1e-12)


def test_the_measured_ramp() -> None:
    ramp = of_steps(0, 1e6 / np.sqrt(200**2 + 2 * 8000 * np.arange(172)))
    assert fit_linear_rows(ramp, 5).largest_relative_error < 0.0305
    assert len(fit_linear_error(ramp, 0.0305).rows) == 5


def test_a_straight_ramp_is_one_row() -> None:
    fitted = fit_linear_rows(of_steps(1, np.arange(1000.0, 500, -5)), 3)
    assert fitted.rows.tolist() == [[100, 1000, -5]]
    assert fitted.largest_relative_error == 0


def test_an_error_out_of_reach_is_refused() -> None:
    with pytest.raises(Rejected, match=r"largest_relative_error is 0.001; allowed: at least 0.2"):
        fit_linear_error(of_steps(1, [2.5]), 0.001)
