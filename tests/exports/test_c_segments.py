from pathlib import Path
from typing import Any

import numpy as np
import pytest

from designs import design
from exports.c_program import PLAY_MOVES, compiled, printed
from exports.test_c_formula import moves_of, profile_with
from stepramp.errors import Rejected
from stepramp.exports.export import Options, export

DESIGNS: dict[str, dict[str, Any]] = {
    "exact": {},
    "newton": {"method": {"name": "newton", "arithmetic": "fixed"}, "ramp__deceleration_steps_per_s2": 3000},
    "second order": {"method": {"name": "second_order", "arithmetic": "float32", "rounding": "floor"}},
    "table": {"method__name": "table"},
    "austin": {"method": {"name": "austin", "arithmetic": "float32"}, "ramp__base_speed_steps_per_s": 50},
    "no ramp": {"ramp__base_speed_steps_per_s": 1000},
    "wide": {"timer__frequency_hz": 1e9, "ramp__acceleration_steps_per_s2": 0.02, "ramp__slew_speed_steps_per_s": 2},
}


@pytest.mark.parametrize("name", DESIGNS)
def test_segments_without_a_bound_give_the_planned_delays(tmp_path: Path, name: str) -> None:
    asked = design(**DESIGNS[name])
    program = compiled(tmp_path, export(asked, "c_segments", Options(name="x")).content.decode(), "x", PLAY_MOVES)
    moves = moves_of(asked)
    np.testing.assert_array_equal(printed(program, moves), np.concatenate([profile_with(asked, n) for n in moves]))


@pytest.mark.parametrize("bound", [1, 50])
def test_with_a_bound_there_are_fewer_and_none_is_further_off(tmp_path: Path, bound: int) -> None:
    asked = design()
    exact, bounded = (
        export(asked, "c_segments", Options(name="x", segment_bound_ticks=ticks)).content.decode()
        for ticks in (0, bound)
    )
    assert bounded.count("\n    {") < exact.count("\n    {")
    played = printed(compiled(tmp_path, bounded, "x", PLAY_MOVES), [2000])
    assert np.abs(played - profile_with(asked, 2000)).max() <= bound


def test_a_ramp_of_too_many_segments_is_refused() -> None:
    long = design(ramp__acceleration_steps_per_s2=0.5, timer__frequency_hz=1e9)
    with pytest.raises(Rejected, match="segment_bound_ticks is 0; allowed: more, so that the ramp takes at most"):
        export(long, "c_segments", Options())
