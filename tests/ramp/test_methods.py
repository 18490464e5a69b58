from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from designs import design, document
from stepramp.design import Design
from stepramp.errors import Rejected
from stepramp.methods import METHODS, tuned
from stepramp.methods.common.method import TunedFor
from stepramp.methods.common.taylor import fixed_taylor_down, taylor_down, taylor_up
from stepramp.methods.exact import exact_intervals
from stepramp.methods.newton import fixed_newton_up
from stepramp.methods.tuned import best_coefficient, coefficient_down, coefficient_up
from stepramp.ramp.plan import ramp_of, real_ramp
from stepramp.ramp.profile import profile_of
from stepramp.shapes.constant import ConstantAcceleration as Slope

COMBINATIONS = [(name, arithmetic) for name, method in METHODS.items() for arithmetic in method.arithmetics]
ROUNDINGS = ("nearest", "floor", "carry")


@pytest.mark.parametrize(("name", "arithmetic"), COMBINATIONS)
@pytest.mark.parametrize("rounding", ROUNDINGS)
def test_every_combination_plans_moves_of_every_length(name: str, arithmetic: str, rounding: str) -> None:
    for steps in (1, 2, 77, -300, 1000):
        profile = profile_of(
            design(
                method__name=name, method__arithmetic=arithmetic, method__rounding=rounding, move__steps=steps,
                ramp__base_speed_steps_per_s=20, ramp__deceleration_steps_per_s2=7000,
            )
        )  # fmt: skip
        assert profile.intervals_ticks.size == abs(steps)
        assert profile.intervals_ticks.min() > 0
        assert profile.position_steps[-1] == steps


@pytest.mark.parametrize("name", ["exact", "ideal", "midpoint", "austin", "table"])
def test_a_combination_that_makes_no_sense_is_refused_by_name(name: str) -> None:
    with pytest.raises(Rejected) as caught:
        Design.checked(document(method__name=name, method__arithmetic="fixed"))
    [rejection] = caught.value.rejections
    assert (rejection.field, rejection.value) == ("method.arithmetic", "fixed")
    assert f"with method.name '{name}'" in rejection.allowed


def test_fixed_is_the_integers_of_the_controller() -> None:
    newton = real_ramp(design(method__name="newton", method__arithmetic="fixed"))
    np.testing.assert_array_equal(newton.up, fixed_newton_up(Slope(2e6, 0, 1000, 5000)).ticks)
    compromise = real_ramp(design(method__name="compromise", method__arithmetic="fixed"))
    np.testing.assert_array_equal(compromise.down, fixed_taylor_down(Slope(2e6, 0, 1000, 5000), 1.0).ticks)


@pytest.mark.parametrize("name", ["first_order", "compromise", "newton"])
def test_fixed_comes_to_the_ticks_of_float64_but_for_one(name: str) -> None:
    fixed, precise = (
        ramp_of(design(method__name=name, method__arithmetic=arithmetic)) for arithmetic in ("fixed", "float64")
    )
    assert np.abs(fixed.up - precise.up).max() <= 1
    assert np.abs(fixed.down - precise.down).max() <= 1


def test_a_ramp_that_fixed_can_t_compute_is_refused_with_the_reason() -> None:
    with pytest.raises(Rejected) as caught:
        profile_of(design(timer__frequency_hz=1e9, ramp__acceleration_steps_per_s2=1, ramp__slew_speed_steps_per_s=10,
                          method__name="newton", method__arithmetic="fixed"))  # fmt: skip
    [rejection] = caught.value.rejections
    assert rejection.field == "method.arithmetic"
    assert "The initial interval is 707,106,781 ticks" in rejection.allowed


@pytest.mark.parametrize(("acceleration", "steps"), [(0.333, "1,501,501"), (0.05, "10,000,000")])
def test_an_arithmetic_whose_errors_run_away_is_refused_with_one_that_does_not(acceleration: float, steps: str) -> None:
    # In float32 w = v² - 2 d - 2 d - … is below 0 before the last step, and Newton's method goes to infinity.
    long = {"method__name": "newton", "ramp__acceleration_steps_per_s2": acceleration, "move__steps": 3_000_000}
    with pytest.raises(Rejected) as caught:
        profile_of(design(**long, method__arithmetic="float32"))
    [rejection] = caught.value.rejections
    assert (rejection.field, rejection.value) == ("method.arithmetic", "float32")
    assert rejection.allowed.startswith(f"float64 for this ramp: over {steps} steps")
    assert profile_of(design(**long, method__arithmetic="float64")).intervals_ticks.min() >= 1999


def tuned_up(slope: Slope, tuned_for: TunedFor) -> np.ndarray:
    return taylor_up(slope, coefficient_up(slope, tuned_for), np.float64)


def tuned_down(slope: Slope, tuned_for: TunedFor) -> np.ndarray:
    return taylor_down(slope, coefficient_down(slope, tuned_for), np.float64)


slopes = st.builds(Slope, st.just(1e6), st.floats(0, 300), st.floats(400, 3000), st.floats(1000, 20_000))


@given(slopes, st.floats(0, 4))
def test_no_other_coefficient_has_a_smaller_largest_error(slope: Slope, coefficient: float) -> None:
    exact = exact_intervals(slope, np.float64)
    if exact.size < 2:
        return
    for side, best_side in ((taylor_up, tuned_up), (taylor_down, tuned_down)):
        best = np.abs(best_side(slope, "largest_error") / exact - 1).max()
        other = np.abs(side(slope, coefficient, np.float64) / exact - 1).max()
        assert best <= other + 1e-6


@given(slopes)
def test_a_ramp_tuned_for_time_takes_the_exact_time_where_any_coefficient_does(slope: Slope) -> None:
    exact = exact_intervals(slope, np.float64).sum()
    for side, best_side in ((taylor_up, tuned_up), (taylor_down, tuned_down)):
        if 0.01 < best_coefficient(slope, side, "time") < 3.99:
            assert best_side(slope, "time").sum() == pytest.approx(exact, rel=1e-6)


def test_tuned_is_better_than_20_22_and_23_from_rest() -> None:
    slope = Slope(1e6, 0, 2000, 4000)
    exact = exact_intervals(slope, np.float64)
    errors = [np.abs(taylor_up(slope, c, np.float64) / exact - 1).max() for c in (0, 1.5, 1)]
    assert [round(float(error), 2) for error in errors] == [0.29, 0.27, 0.06]
    assert np.abs(tuned_up(slope, "largest_error") / exact - 1).max() < 0.02


def test_the_coefficient_is_searched_for_once_for_all_arithmetics_and_requests(monkeypatch: pytest.MonkeyPatch) -> None:
    tried = []

    def counted(*arguments: Any) -> np.ndarray:
        tried.append(arguments)
        return taylor_up(*arguments)

    monkeypatch.setattr(tuned, "taylor_up", counted)
    slower = {"method__name": "tuned", "ramp__acceleration_steps_per_s2": 4321.5}
    first = real_ramp(design(**slower, method__arithmetic="float64"))
    searched = len(tried)
    assert searched > 20
    for arithmetic in ("float32", "fixed", "float64"):
        real_ramp(design(**slower, method__arithmetic=arithmetic, move__steps=17))
    assert len(tried) == searched
    np.testing.assert_array_equal(real_ramp(design(**slower, method__arithmetic="float64")).up, first.up)
    real_ramp(design(**slower, method__tuned_for="time"))
    assert len(tried) > searched
