"""Exported formulas are compiled and run; every delay is that of the profile."""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from designs import design
from exports.c_program import PLAY_MOVES, compiled, printed
from stepramp.design import Design
from stepramp.errors import Rejected
from stepramp.exports.export import Options, export
from stepramp.ramp.plan import plan_of
from stepramp.ramp.profile import profile_of

FORMULAS = ("first_order", "second_order", "compromise", "newton")
ARITHMETICS = ("float32", "float64", "fixed")
ROUNDINGS = ("nearest", "floor", "carry")
RAMPS: dict[str, dict[str, Any]] = {
    "from rest": {},
    "base speed": {"ramp__base_speed_steps_per_s": 137.5},
    "slow down harder": {"ramp__deceleration_steps_per_s2": 13_000},
    "slow down softer": {"ramp__deceleration_steps_per_s2": 1_700, "timer__frequency_hz": 1_000_000},
    "no ramp": {"ramp__base_speed_steps_per_s": 1000},
    "up only": {"ramp__base_speed_steps_per_s": 900, "ramp__deceleration_steps_per_s2": 1e6},
    "down only": {"ramp__base_speed_steps_per_s": 900, "ramp__acceleration_steps_per_s2": 1e6,
                  "ramp__deceleration_steps_per_s2": 4000},
    "few ticks": {"timer__frequency_hz": 10_000, "ramp__acceleration_steps_per_s2": 9000},
}  # fmt: skip
"""Ramps of 0 to 300 steps a side."""


def moves_of(asked: Design) -> list[int]:
    """Return lengths of moves, from the shortest to beyond the whole ramp."""
    ramp = plan_of(asked).ramp
    whole = ramp.up.size + ramp.down.size
    return sorted(
        {1, 2, 3, 4, 7, whole // 3, whole // 2, whole - 2, whole - 1, whole, whole + 1, whole + 9} - {-2, -1, 0}
    )


def profile_with(asked: Design, steps: int) -> np.ndarray:
    return profile_of(asked.model_copy(update={"move": asked.move.model_copy(update={"steps": steps})})).intervals_ticks


def check(asked: Design, folder: Path) -> None:
    header = export(asked, f"c_{asked.method.name}", Options(name="stage")).content.decode()  # type: ignore[arg-type]
    moves = moves_of(asked)
    expected = np.concatenate([profile_with(asked, steps) for steps in moves])
    np.testing.assert_array_equal(printed(compiled(folder, header, "stage", PLAY_MOVES), moves), expected)


@pytest.mark.parametrize("ramp", RAMPS)
@pytest.mark.parametrize("arithmetic", ARITHMETICS)
@pytest.mark.parametrize("formula", FORMULAS)
def test_the_code_of_a_formula_gives_the_planned_delays(
    tmp_path: Path, formula: str, arithmetic: str, ramp: str
) -> None:
    check(design(method__name=formula, method__arithmetic=arithmetic, **RAMPS[ramp]), tmp_path)


@pytest.mark.parametrize("rounding", ["floor", "carry"])
@pytest.mark.parametrize("arithmetic", ARITHMETICS)
@pytest.mark.parametrize("formula", ["second_order", "newton"])
def test_it_rounds_as_planned(tmp_path: Path, formula: str, arithmetic: str, rounding: str) -> None:
    method = {"name": formula, "arithmetic": arithmetic, "rounding": rounding}
    check(design(method=method, ramp__deceleration_steps_per_s2=3_333, timer__frequency_hz=76_543), tmp_path)


@given(
    formula=st.sampled_from(FORMULAS),
    arithmetic=st.sampled_from(ARITHMETICS),
    rounding=st.sampled_from(ROUNDINGS),
    timer_hz=st.floats(1e4, 1e8),
    slew=st.floats(100, 20_000),
    base=st.just(0.0) | st.floats(0.001, 0.9),
    steps_up=st.floats(0.5, 400),
    steps_down=st.floats(0.5, 400),
)
@settings(max_examples=40)
def test_it_gives_the_planned_delays_of_any_ramp(
    formula: str, arithmetic: str, rounding: str, timer_hz: float, slew: float, base: float, steps_up: float,
    steps_down: float,
) -> None:  # fmt: skip
    rise = slew**2 * (1 - base**2) / 2
    asked = design(
        method={"name": formula, "arithmetic": arithmetic, "rounding": rounding},
        timer__frequency_hz=timer_hz,
        ramp={
            "base_speed_steps_per_s": base * slew, "slew_speed_steps_per_s": slew,
            "acceleration_steps_per_s2": rise / steps_up, "deceleration_steps_per_s2": rise / steps_down,
        },
    )  # fmt: skip
    try:
        plan_of(asked)
    except Rejected:
        assume(False)
    with tempfile.TemporaryDirectory() as folder:
        check(asked, Path(folder))


@pytest.mark.parametrize("formula", FORMULAS)
def test_a_long_ramp_in_fixed_numbers_changes_its_exponents_as_planned(tmp_path: Path, formula: str) -> None:
    check(design(method={"name": formula, "arithmetic": "fixed"}, ramp__acceleration_steps_per_s2=9), tmp_path)


def test_intervals_beyond_32_bits_are_counted(tmp_path: Path) -> None:
    slow = {"base_speed_steps_per_s": 0, "slew_speed_steps_per_s": 0.2, "acceleration_steps_per_s2": 0.004}
    check(design(method={"name": "newton", "arithmetic": "float64"}, ramp=slow, timer__frequency_hz=1e9), tmp_path)


def test_a_formula_is_in_the_design_s_numbers_when_it_is_its_method_else_in_the_usual_ones() -> None:
    own = design(method__name="newton", method__arithmetic="fixed")
    assert "in fixed." in export(own, "c_newton", Options()).content.decode()
    assert "in float32." in export(own, "c_compromise", Options()).content.decode()
    assert "in float64." in export(own, "c_compromise", Options(arithmetic="float64")).content.decode()


def test_a_ramp_that_the_arithmetic_can_t_compute_is_refused() -> None:
    slow = design(
        method={"name": "newton", "arithmetic": "fixed"}, timer__frequency_hz=1e9, ramp__acceleration_steps_per_s2=10
    )
    with pytest.raises(Rejected, match=r"method\.arithmetic is 'fixed'; allowed: float64 for this ramp"):
        export(slow, "c_newton", Options())
