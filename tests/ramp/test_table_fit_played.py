"""Fitted tables as they are played, by a player made from the gauge library's record alone."""

import itertools
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from designs import design
from stepramp.errors import Rejected
from stepramp.ramp.error_curves import error_curves
from stepramp.ramp.table_delays import ramp_delays
from stepramp.ramp.table_fit import fit_error, fit_rows, floor_of
from stepramp.ramp.table_fit_linear import fit_linear_rows

RECORD = json.loads((Path(__file__).parents[1] / "reference" / "gauge_table_moves.json").read_text())
FROM_REST = [case for case in RECORD["cases"] if len(case["targets"]) == 1]

SMALL = {
    "from rest": (1000, 0, 200, 5000, 5000),
    "from a base speed": (1000, 80, 200, 4000, 4000),
    "stops sooner": (1500, 0, 200, 5000, 9000),
    "starts sooner": (1500, 0, 200, 9000, 5000),
    "from a base speed, stops much sooner": (1500, 60, 200, 2500, 20_000),
    "no ramp": (1000, 0, 100, 6000, 6000),
}
"""F, v0, v, a, d: of a few steps, in ticks so coarse that all tables can be tried."""

LARGE = {
    "from rest": (1e6, 0, 1000, 5000, 5000),
    "a gauge": (1e6, 200, 1666, 8000, 8000),
    "stops sooner": (1e6, 100, 2000, 4000, 8000),
    "starts sooner": (1e6, 0, 1000, 20_000, 2000),
}


def ramp_indices(top: int, target: int) -> list[list[int]]:
    """Return the ramp index after each step towards a target, a list for each way between two stops.

    As recorded: from rest the first step counts as one; then the index falls when it is more than the steps left, or
    rises up to the last row's. A short way of an even number of steps ends one too far, and one step leads back.
    """
    ways: list[list[int]] = []
    position, index, direction = 0, 0, 1
    while index or position != target:
        if index == 0:
            ways.append([])
            direction, index = (1 if target > position else -1), 1
        position += direction
        index = index - 1 if (target - position) * direction < index else min(index + 1, top)
        ways[-1].append(index)
    return ways


def exact_move(steps: int, timer_hz: float, base: float, slew: float, *accelerations: float) -> list[float]:
    """Return the delays of a move by p = F / sqrt(v0² + 2 a i), of the slowest of both sides [ticks]."""
    up, down = (
        [timer_hz / math.sqrt(base**2 + 2 * a * i) for i in range(1, math.floor((slew**2 - base**2) / (2 * a)) + 1)]
        for a in accelerations
    )
    n_up = n_down = 0
    while n_up + n_down < min(steps, len(up) + len(down)):
        is_up = n_down == len(down) or (n_up < len(up) and up[n_up] >= down[n_down])
        n_up, n_down = n_up + is_up, n_down + (not is_up)
    return up[:n_up] + [timer_hz / slew] * (steps - n_up - n_down) + down[:n_down][::-1]


def steps_played(top: int, ramp: tuple[float, ...], targets: range | list[int]) -> set[tuple[int, float]]:
    """Return the ramp index and the exact delay of each step of moves to all targets, each from rest."""
    ways = {tuple(way) for target in targets for way in ramp_indices(top, target)}
    return {step for way in ways for step in zip(way, exact_move(len(way), *ramp), strict=True)}


def played_error(rows: list[list[int]], ramp: tuple[float, ...], targets: range | list[int]) -> float:
    """Return the largest relative error of the delays of a table of constant rows."""

    def delay(index: int) -> int:
        return next(delay for last, delay in rows if last >= index)

    return max(abs(delay(index) / exact - 1) for index, exact in steps_played(rows[-1][0], ramp, targets))


def least_error(ramp: tuple[float, ...], rows: int, most_top: int, targets: range) -> float:
    """Try every last index, every way to cut the indices into at most so many rows, and every delay of a row."""
    return min(_least_error_to(top, ramp, rows, targets) for top in range(2, most_top + 1))


def _least_error_to(top: int, ramp: tuple[float, ...], rows: int, targets: range) -> float:
    exact: dict[int, set[float]] = {index: set() for index in range(top + 1)}
    for index, delay in steps_played(top, ramp, targets):
        exact[index].add(delay)
    longest = math.ceil(max(max(delays) for delays in exact.values()))

    def best_row(first: int, end: int) -> float:
        delays = [delay for index in range(first, end) for delay in exact[index]]
        return min(max(abs(whole / delay - 1) for delay in delays) for whole in range(1, longest + 1))

    row = {(a, b): best_row(a, b) for a in range(top + 1) for b in range(a + 1, top + 2)}
    cuts = (cut for count in range(rows) for cut in itertools.combinations(range(1, top + 1), count))
    return min(max(row[pair] for pair in itertools.pairwise((0, *cut, top + 1))) for cut in cuts)


def design_of(timer_hz: float, base: float, slew: float, up: float, down: float, **changes: Any) -> Any:
    return design(
        timer__frequency_hz=timer_hz, ramp__base_speed_steps_per_s=base, ramp__slew_speed_steps_per_s=slew,
        ramp__acceleration_steps_per_s2=up, ramp__deceleration_steps_per_s2=down, **changes,
    )  # fmt: skip


@pytest.mark.parametrize("case", FROM_REST, ids=[case["name"] for case in FROM_REST])
def test_the_player_is_that_of_the_record(case: dict[str, Any]) -> None:
    [way] = ramp_indices(case["table"][-1][0], case["targets"][0]["target"])
    assert way == [step[3] for step in case["steps"]]


@pytest.mark.parametrize("rows", [1, 2, 3, 4, 9])
@pytest.mark.parametrize("name", SMALL)
def test_no_table_is_played_better(name: str, rows: int) -> None:
    ramp, targets = SMALL[name], range(1, 40)
    fitted = fit_rows(ramp_delays(design_of(*ramp), "ticks"), rows)
    assert len(fitted.rows) <= rows
    best = least_error(ramp, rows, max(len(fitted.rows), int(fitted.rows[-1, 0])) + 1, targets)
    assert fitted.largest_relative_error == pytest.approx(best, abs=1e-12)
    assert played_error(fitted.rows.tolist(), ramp, targets) == pytest.approx(best, abs=1e-12)


@pytest.mark.parametrize("rows", [5, 8, 16, 60])
@pytest.mark.parametrize("name", LARGE)
def test_what_a_fit_promises_is_what_is_played(name: str, rows: int) -> None:
    ramp = LARGE[name]
    fitted = fit_rows(ramp_delays(design_of(*ramp), "us"), rows)
    assert len(fitted.rows) <= rows
    top = int(fitted.rows[-1, 0])
    targets = [1, 2, 3, 4, 5, 6, 7, 10, 25, 50, 51, top - 1, top, 2 * top - 2, 2 * top - 1, 2 * top, 3 * top]
    played = played_error(fitted.rows.tolist(), ramp, targets)
    assert fitted.largest_relative_error == pytest.approx(played, abs=1e-12)


@pytest.mark.parametrize("name", LARGE)
def test_the_method_table_is_nowhere_worse(name: str) -> None:
    # StepRamp's own moves end where they should, also short ones of an even number of steps.
    ramp = LARGE[name]
    fitted = fit_rows(ramp_delays(design_of(*ramp), "us"), 12)
    for steps in (1, 2, 3, 4, 8, 31, 100, 250, 3000):
        table = design_of(*ramp, method__name="table", table__rows=fitted.rows.tolist(), move__steps=steps)
        largest = error_curves(table, "table", "exact").largest_relative_error.value
        assert abs(largest) <= fitted.largest_relative_error + 1e-12


def test_linear_rows_are_played_as_they_promise() -> None:
    ramp = LARGE["from rest"]
    fitted = fit_linear_rows(ramp_delays(design_of(*ramp), "us"), 4)
    delays, first = [], 0
    for last, delay, add in fitted.rows.tolist():
        delays += [delay + add * (index - first) for index in range(first, last + 1)]
        first = last + 1
    alone = [[index, delay] for index, delay in enumerate(delays)]
    assert fitted.largest_relative_error == pytest.approx(played_error(alone, ramp, [1, 2, 7, 40, 300]), abs=1e-12)


def test_the_floor_is_what_no_number_of_rows_goes_below() -> None:
    # From rest index 2 plays p1 up and p3 = p1 / sqrt(3) down: off by (sqrt(3) - 1) / (sqrt(3) + 1) = 26.79 %.
    ramp = ramp_delays(design_of(*LARGE["from rest"]), "us")
    floor = floor_of(ramp)
    assert floor.ramp_index == 2
    assert floor.relative_error == pytest.approx((math.sqrt(3) - 1) / (math.sqrt(3) + 1), abs=1e-4)
    for rows in (8, 60, 1000):
        assert fit_rows(ramp, rows).largest_relative_error == floor.relative_error
    with pytest.raises(Rejected, match=r"at least 0\.268, .* steps of different speeds play the same ramp index"):
        fit_error(ramp, 0.26)
    assert fit_error(ramp, 0.268).largest_relative_error <= 0.268


def test_rows_beyond_what_mends_the_worst_index_mend_the_others() -> None:
    ramp = ramp_delays(design_of(*LARGE["from rest"]), "us")
    few, more, many = (fit_rows(ramp, rows).relative_errors[-1] for rows in (8, 16, 60))
    assert few > 2 * more > 4 * many


def test_a_table_in_the_ramp_s_own_index_is_fitted_when_it_is_asked_for() -> None:
    ramp = ramp_delays(design_of(*LARGE["from rest"]), "us", "ramp_index")
    np.testing.assert_array_equal(ramp.longest, ramp.shortest)
    assert ramp.first_index == 1
    assert ramp.longest == pytest.approx([*(1e6 / np.sqrt(10_000 * np.arange(1, 101))), 1000])


@pytest.mark.parametrize("which", ["acceleration", "deceleration"])
def test_a_side_of_more_steps_than_16_bits_count_is_refused(which: str) -> None:
    def ramp(rate: float) -> Any:
        rates = {"acceleration": 9000, "deceleration": 9000} | {which: rate}
        return ramp_delays(design_of(2e6, 0, 10_000, *rates.values()), "us")

    # 10,000² / (2 · 65,533) = 762.9744: what is allowed is rounded up.
    with pytest.raises(Rejected, match=rf"ramp\.{which}_steps_per_s2 is 700.0; allowed: at least 762\.975 steps/s²"):
        ramp(700)
    assert ramp(762.975).longest.size <= 65_536
