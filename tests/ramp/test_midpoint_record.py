import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from designs import design
from stepramp.ramp.profile import profile_of

RECORD = json.loads((Path(__file__).parents[1] / "reference" / "trapezoid_moves.json").read_text())


def planned(case: dict[str, Any], steps: int, **changes: Any) -> np.ndarray:
    step_mm = case["step_mm"]
    return profile_of(
        design(
            method__name="midpoint",
            timer__frequency_hz=1_000_000,
            ramp__slew_speed_steps_per_s=case["max_speed_mm_per_s"] / step_mm,
            ramp__acceleration_steps_per_s2=case["acceleration_mm_per_s2"] / step_mm,
            move__steps=steps,
            **changes,
        )
    ).intervals_ticks


@pytest.mark.parametrize("case", RECORD["cases"], ids=[f"{case['distance_mm']} mm" for case in RECORD["cases"]])
def test_the_published_loop_s_delays_within_a_microsecond(case: dict[str, Any]) -> None:
    recorded = np.array(case["delays_us"])
    for arithmetic in ("float64", "float32"):
        delays = planned(case, recorded.size, method__arithmetic=arithmetic)
        assert np.abs(delays - recorded).max() <= 1
        # Where the loop went wrong: backwards it is the same, not nothing.
        np.testing.assert_array_equal(planned(case, -recorded.size, method__arithmetic=arithmetic), delays)


def test_moves_that_rounding_makes_a_step_longer_end_well() -> None:
    # The published loop takes the square root of a negative number when rounding adds a step.
    case = RECORD["cases"][0]
    for steps in range(1, 60):
        delays = planned(case, steps, ramp__base_speed_steps_per_s=13.7, ramp__deceleration_steps_per_s2=7777)
        assert delays.size == steps
        assert delays.min() > 0
