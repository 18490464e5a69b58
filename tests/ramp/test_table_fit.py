import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from designs import design
from stepramp.errors import Rejected
from stepramp.ramp.table_delays import WIDEST, RampDelays, ramp_delays
from stepramp.ramp.table_fit import FittedTable, fit_error, fit_rows

delay_lists = st.lists(st.floats(2, 60), min_size=1, max_size=7)


def error_of(rows: list[tuple[int, int]], delays: list[float]) -> float:
    """Play a table and compare each delay; ramp indices count from 1."""
    largest = 0.0
    for index, delay in enumerate(delays, start=1):
        row_delay = next(delay for last, delay in rows if last >= index)
        largest = max(largest, abs(row_delay / delay - 1))
    return largest


def least_error(delays: list[float], rows: int) -> float:
    """Try every way to cut the delays into at most so many rows, and every whole delay of a row."""

    def best_row(part: list[float]) -> float:
        whole = range(max(1, math.floor(min(part))), math.ceil(max(part)) + 1)
        return min(max(abs(delay / each - 1) for each in part) for delay in whole)

    best = math.inf
    for count in range(1, min(rows, len(delays)) + 1):
        for cuts in itertools.combinations(range(1, len(delays)), count - 1):
            ends = (0, *cuts, len(delays))
            best = min(best, max(best_row(delays[a:b]) for a, b in itertools.pairwise(ends)))
    return best


def of_steps(delays: list[float]) -> RampDelays:
    """Return what a table stands for where each ramp index plays one step."""
    return RampDelays(1, np.array(delays), np.array(delays))


def fit(delays: list[float], rows: int) -> FittedTable:
    return fit_rows(of_steps(delays), rows)


@given(delay_lists, st.integers(1, 5))
def test_no_table_of_as_many_rows_is_better(delays: list[float], rows: int) -> None:
    fitted = fit(delays, rows)
    assert len(fitted.rows) <= rows
    assert fitted.largest_relative_error == pytest.approx(least_error(delays, rows), abs=1e-12)


@given(delay_lists, st.integers(1, 5))
def test_the_error_it_states_is_the_error_it_has(delays: list[float], rows: int) -> None:
    fitted = fit(delays, rows)
    table = [(index, delay) for index, delay in fitted.rows.tolist()]
    assert fitted.largest_relative_error == pytest.approx(error_of(table, delays), abs=1e-12)


@given(delay_lists, st.floats(0.0001, 0.9))
def test_no_table_of_fewer_rows_keeps_an_error(delays: list[float], error: float) -> None:
    achievable, ramp = least_error(delays, len(delays)), of_steps(delays)
    if achievable > error:
        with pytest.raises(Rejected, match=r"largest_relative_error is .*; allowed: at least"):
            fit_error(ramp, error)
        return
    fitted = fit_error(ramp, error)
    assert fitted.largest_relative_error <= error + 1e-12
    if len(fitted.rows) > 1:
        assert least_error(delays, len(fitted.rows) - 1) > error - 1e-12


@given(st.data())
def test_a_random_table_never_beats_the_fitted_one(data: st.DataObject) -> None:
    delays = (1e6 / np.sqrt(200**2 + 2 * 8000 * np.arange(1, 171))).tolist()
    count = data.draw(st.integers(1, 12))
    cuts = sorted(data.draw(st.sets(st.integers(1, 169), min_size=count - 1, max_size=count - 1)))
    rows = []
    for a, b in itertools.pairwise((0, *cuts, 170)):
        rows.append((b, data.draw(st.integers(int(delays[b - 1]), int(delays[a]) + 1))))
    assert error_of(rows, delays) >= fit(delays, count).largest_relative_error - 1e-12


def test_the_measured_ramp() -> None:
    # v0 200, v 1666, a 8000, F 1 MHz: 172 delays; 19.79 % for 5 rows and 5.79 % for 16 before delays are whole.
    gauge = design(
        timer__frequency_hz=1e6, ramp__base_speed_steps_per_s=200, ramp__slew_speed_steps_per_s=1666,
        ramp__acceleration_steps_per_s2=8000,
    )  # fmt: skip
    ramp = ramp_delays(gauge, "us", "ramp_index")
    assert (ramp.first_index, ramp.longest.size) == (0, 172)
    assert fit_rows(ramp, 5).largest_relative_error == pytest.approx(0.1979, abs=1e-4)
    assert fit_rows(ramp, 16).largest_relative_error == pytest.approx(0.0579, abs=2e-4)


def test_delays_wider_than_16_bits_are_not_used() -> None:
    fitted = fit([90_000.0, 80_000.0, 500.0], 3)
    assert fitted.rows[:, 1].max() == WIDEST
    assert fitted.largest_relative_error == pytest.approx(1 - WIDEST / 90_000)


def test_a_design_with_a_table_is_fitted_to_the_exact_ramp() -> None:
    exact, table = (ramp_delays(design(method__name=name), "ticks") for name in ("exact", "table"))
    np.testing.assert_array_equal(exact.longest, table.longest)
    np.testing.assert_array_equal(exact.shortest, table.shortest)
