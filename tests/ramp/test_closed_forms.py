from itertools import pairwise

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepramp.methods.exact import exact_intervals
from stepramp.methods.ideal import ideal_intervals
from stepramp.methods.midpoint import midpoint_intervals
from stepramp.shapes.constant import ConstantAcceleration as Slope

speeds = st.floats(0.5, 200_000)
accelerations = st.floats(1, 1e7)
slopes = st.builds(
    lambda timer_hz, base, gain, acceleration: Slope(timer_hz, base, base + gain, acceleration),
    st.floats(1e4, 1e8), st.floats(0, 1000), st.floats(0.5, 5000), st.floats(1e4, 1e7),
)  # fmt: skip


def recursion_9(slope: Slope, steps: int) -> list[mpmath.mpf]:
    """Compute formula (9) as it stands, from p1 (17), with 50 digits."""
    with mpmath.workdps(50):
        frequency, rate = mpmath.mpf(slope.timer_hz), mpmath.mpf(slope.acceleration)
        interval = frequency / mpmath.sqrt(mpmath.mpf(slope.base_speed) ** 2 + 2 * rate)
        intervals = [interval]
        for _ in range(steps - 1):
            interval = interval / mpmath.sqrt(1 + interval**2 * 2 * rate / frequency**2)
            intervals.append(interval)
    return intervals[:steps]


def close(got: np.ndarray, expected: list[mpmath.mpf]) -> bool:
    """Whether numbers are within four units in the last place."""
    want = np.array([float(each) for each in expected])
    return got.size == want.size and bool(np.all(np.abs(got - want) <= 4 * np.spacing(want)))


@given(slopes)
def test_exact_is_formula_9(slope: Slope) -> None:
    steps = min(slope.steps, 40)
    assert close(exact_intervals(slope, np.float64)[:steps], recursion_9(slope, steps))


@given(slopes)
def test_midpoint_has_the_speed_at_the_centre_of_each_step(slope: Slope) -> None:
    got = midpoint_intervals(slope, np.float64)
    with mpmath.workdps(50):
        expected = [
            mpmath.mpf(slope.timer_hz)
            / mpmath.sqrt(
                mpmath.mpf(slope.base_speed) ** 2 + 2 * mpmath.mpf(slope.acceleration) * (i - mpmath.mpf(0.5))
            )
            for i in range(1, min(got.size, 40) + 1)
        ]
    assert close(got[:40], expected)
    assert got.size in (slope.steps, slope.steps + 1)


@given(slopes)
def test_ideal_is_the_time_between_true_instants(slope: Slope) -> None:
    got = ideal_intervals(slope, np.float64)[:40]
    with mpmath.workdps(50):
        base, rate = mpmath.mpf(slope.base_speed), mpmath.mpf(slope.acceleration)
        instants = [(mpmath.sqrt(base**2 + 2 * rate * i) - base) / rate for i in range(got.size + 1)]
        expected = [mpmath.mpf(slope.timer_hz) * (b - a) for a, b in pairwise(instants)]
    assert close(got, expected)


def test_float32_is_computed_in_float32() -> None:
    slope = Slope(2e6, 0, 1000, 5000)
    expected = [float(np.float32(2e6) / np.sqrt(np.float32(10000) * np.float32(i))) for i in range(1, 101)]
    np.testing.assert_array_equal(exact_intervals(slope, np.float32), np.array(expected, np.float32))
    for method in (exact_intervals, midpoint_intervals, ideal_intervals):
        assert method(slope, np.float32).dtype == np.float32


def test_initial_and_slew_interval_and_multiplier_are_formulas_17_to_19() -> None:
    slope = Slope(1e6, 100, 2000, 4000)
    assert slope.initial_interval == pytest.approx(1e6 / 18000**0.5, rel=1e-15)
    assert slope.slew_interval == 500
    assert slope.multiplier == pytest.approx(4e-9, rel=1e-15)


@pytest.mark.parametrize(
    ("base", "slew", "acceleration", "steps"),
    [(0, 1000, 5000, 100), (0, 2000, 4000, 500), (100, 2000, 4000, 498), (0, 10, 1000, 0), (5, 5, 1, 0)],
)
def test_ramp_length_is_formula_16_rounded_down(base: float, slew: float, acceleration: float, steps: int) -> None:
    assert Slope(1e6, base, slew, acceleration).steps == steps


def test_speeds_at_the_end_of_steps_make_a_ramp_from_rest_3_percent_shorter_than_constant_acceleration() -> None:
    slope = Slope(1e6, 0, 2000, 4000)
    ideal = ideal_intervals(slope, np.float64).sum()
    assert exact_intervals(slope, np.float64).sum() / ideal == pytest.approx(0.97, abs=0.005)
    assert abs(midpoint_intervals(slope, np.float64).sum() / ideal - 1) < 0.015


@given(slopes)
def test_no_interval_of_a_ramp_is_shorter_than_at_slew_speed(slope: Slope) -> None:
    for method in (exact_intervals, midpoint_intervals, ideal_intervals):
        assert np.all(method(slope, np.float64) >= slope.slew_interval * (1 - 1e-12))
