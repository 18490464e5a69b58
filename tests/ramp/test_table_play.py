import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepramp.errors import Rejected
from stepramp.ramp.table_play import TableMoves, play_table

RECORD = json.loads((Path(__file__).parents[1] / "reference" / "gauge_table_moves.json").read_text())
ROWS = [[10, 5000], [30, 1500], [100, 1000], [150, 800], [300, 600]]


def play(rows: list[list[int]], range_steps: int, targets: list[tuple[int, int]]) -> TableMoves:
    at_us, wanted = np.array(targets, dtype=np.int64).reshape(-1, 2).T
    return play_table(np.array(rows), range_steps, at_us, wanted)


@pytest.mark.parametrize("case", RECORD["cases"], ids=[case["name"] for case in RECORD["cases"]])
def test_every_recorded_move_is_played_exactly(case: dict[str, Any]) -> None:
    moves = play(case["table"], case["range_steps"], [(each["at_us"], each["target"]) for each in case["targets"]])
    played = np.stack([moves.at_us, moves.position, moves.direction, moves.ramp_index, moves.delay_us], axis=1)
    np.testing.assert_array_equal(played, case["steps"])
    np.testing.assert_array_equal(np.stack([moves.stop_at_us, moves.stop_position], axis=1), case["stops"])


@pytest.mark.parametrize(("target", "position"), [(5000, 944), (-3, 0)])
def test_a_target_outside_the_range_is_kept_within_it(target: int, position: int) -> None:
    moves = play(ROWS, 945, [(0, 100), (10_000_000, target)])
    assert moves.stop_position.tolist() == [100, position]


def test_a_target_that_is_reached_already_moves_nothing() -> None:
    moves = play(ROWS, 945, [(0, 0), (1000, 0)])
    assert moves.at_us.size == moves.stop_at_us.size == 0
    assert play(ROWS, 945, []).at_us.size == 0


def test_at_rest_the_first_step_comes_with_the_target() -> None:
    moves = play(ROWS, 945, [(7000, 1), (50_000, 0)])
    assert moves.at_us.tolist() == [7000, 50_000]
    assert moves.stop_at_us.tolist() == [12_000, 55_000]


def test_moves_without_end_are_refused() -> None:
    targets = [(number * 10_000_000_000, number % 2 * 9_999_999) for number in range(4)]
    with pytest.raises(Rejected, match="at most 10,000,000 steps"):
        play(ROWS, 10_000_000, targets)


@given(
    st.lists(st.tuples(st.integers(0, 2_000_000), st.integers(0, 944)), min_size=1, max_size=6),
    st.lists(st.tuples(st.integers(1, 40), st.integers(100, 5000)), min_size=1, max_size=5),
)
def test_laws_of_all_moves(targets: list[tuple[int, int]], parts: list[tuple[int, int]]) -> None:
    rows = [[sum(length for length, _ in parts[: n + 1]), delay] for n, (_, delay) in enumerate(parts)]
    moves = play(rows, 945, sorted(targets))
    assert np.all(np.diff(moves.at_us) >= 100)
    assert np.all(np.abs(np.diff(moves.position, prepend=0)) <= 1)
    assert np.all((moves.position >= 0) & (moves.position <= 945))
    assert np.all(np.abs(np.diff(moves.ramp_index)) <= 2)
    turns = np.flatnonzero(np.diff(moves.direction))
    assert np.all(moves.ramp_index[turns] == 0)
    if moves.at_us.size:
        assert moves.stop_position[-1] == max(sorted(targets), key=lambda each: each[0])[1] or len(targets) > 1
        assert moves.stop_at_us[-1] == moves.at_us[-1] + moves.delay_us[-1]
