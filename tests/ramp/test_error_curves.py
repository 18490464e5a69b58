import numpy as np
import pytest

from designs import design
from stepramp.errors import Rejected
from stepramp.ramp.error_curves import error_curve


def test_exact_against_itself_is_off_by_rounding_alone() -> None:
    curve = error_curve(design(), "exact", "exact")
    assert np.all(np.abs(curve.tick_error) <= 0.5)
    assert abs(curve.largest_relative_error.value) < 0.5 / 2000


def test_formula_20_from_rest_is_29_percent_short_at_step_2() -> None:
    curve = error_curve(design(move__steps=200, ramp__deceleration_steps_per_s2=1e6), "first_order", "exact")
    assert curve.largest_relative_error.step == 2
    assert curve.largest_relative_error.value == pytest.approx(0.5 / 0.5**0.5 - 1, abs=1e-3)
    assert curve.tick_error[1] == pytest.approx(10_000 - 20_000 / 2**0.5, abs=0.51)


def test_the_gauge_table_is_up_to_80_percent_off_a_constant_acceleration() -> None:
    # v0 200, v 1666, a 8000: the ramp for which the published table was measured.
    gauge = design(
        timer__frequency_hz=1e6, ramp__base_speed_steps_per_s=200, ramp__slew_speed_steps_per_s=1666,
        ramp__acceleration_steps_per_s2=8000, move__steps=1000,
    )  # fmt: skip
    curve = error_curve(gauge, "table", "exact")
    own = 1e6 / np.sqrt(200**2 + 2 * 8000 * np.arange(1, 172))
    np.testing.assert_allclose(curve.relative_error[:9], 5000 / own[:9] - 1)
    assert curve.relative_error.max() > 0.8


def test_a_table_is_needed_to_compare_one() -> None:
    with pytest.raises(Rejected, match=r"table is missing"):
        error_curve(design(table=None), "table", "exact")


def test_every_step_has_an_error() -> None:
    for steps in (1, 2, 77, -500):
        for method in ("exact", "first_order", "table"):
            assert error_curve(design(move__steps=steps), method, "exact").relative_error.size == abs(steps)
