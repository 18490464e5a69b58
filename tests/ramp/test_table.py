import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from designs import design
from stepramp.methods.table import table_ramp
from stepramp.ramp.profile import profile_of

RECORD = json.loads((Path(__file__).parents[1] / "reference" / "gauge_table_moves.json").read_text())
FROM_REST = [case for case in RECORD["cases"] if len(case["targets"]) == 1]


@pytest.mark.parametrize("case", FROM_REST, ids=[case["name"] for case in FROM_REST])
def test_a_move_from_rest_has_the_delays_that_the_gauge_library_played(case: dict[str, Any]) -> None:
    target = case["targets"][0]["target"]
    profile = profile_of(
        design(method__name="table", table__rows=case["table"], timer__frequency_hz=1_000_000, move__steps=target)
    )
    recorded = np.array(case["steps"])
    np.testing.assert_array_equal(profile.intervals_ticks, recorded[:, 4])
    np.testing.assert_array_equal(profile.position_steps, recorded[:, 1])
    np.testing.assert_allclose(profile.time_s * 1e6, recorded[:, 0], rtol=0, atol=1e-6)


def test_the_published_table_steps_9_times_at_5000_and_20_times_at_1500() -> None:
    ramp = table_ramp(np.array([10, 30, 100, 150, 300]), np.array([5000.0, 1500, 1000, 800, 600]))
    delays, counts = np.unique(ramp.up, return_counts=True)
    assert dict(zip(delays.tolist(), counts.tolist(), strict=True)) == {5000: 9, 1500: 20, 1000: 70, 800: 50, 600: 150}
    assert ramp.slew == 600
    assert ramp.down.size == 300


def test_a_table_in_ticks_is_played_as_it_stands() -> None:
    profile = profile_of(
        design(method__name="table", table__rows=[[2, 900], [4, 400]], table__interval_unit="ticks", move__steps=8)
    )
    assert profile.intervals_ticks.tolist() == [900, 400, 400, 400, 400, 900, 900, 900]


def test_a_table_of_one_row_and_one_step_has_no_acceleration() -> None:
    profile = profile_of(design(method__name="table", table__rows=[[1, 1000]], move__steps=3))
    assert profile.intervals_ticks.tolist() == [2000, 2000, 2000]
