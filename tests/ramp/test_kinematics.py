import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepramp.ramp.kinematics import exact_intervals, initial_interval, ramp_steps, slew_interval

speeds = st.floats(0.5, 200_000)
accelerations = st.floats(1, 1e7)
timers = st.floats(1e4, 1e8)


def recursion_9(timer_hz: float, base: float, acceleration: float, steps: int) -> list[mpmath.mpf]:
    """Formula (9) as it stands, from p1 (17), with 50 digits."""
    with mpmath.workdps(50):
        frequency, rate = mpmath.mpf(timer_hz), mpmath.mpf(acceleration)
        interval = frequency / mpmath.sqrt(mpmath.mpf(base) ** 2 + 2 * rate)
        intervals = [interval]
        for _ in range(steps - 1):
            interval = interval / mpmath.sqrt(1 + interval**2 * 2 * rate / frequency**2)
            intervals.append(interval)
    return intervals


@given(timers, st.floats(0, 1000), accelerations)
def test_exact_is_formula_9_within_four_ulps(timer_hz: float, base: float, acceleration: float) -> None:
    expected = np.array([float(each) for each in recursion_9(timer_hz, base, acceleration, 40)])
    got = exact_intervals(timer_hz, base, acceleration, 40)
    assert np.all(np.abs(got - expected) <= 4 * np.spacing(expected))


def test_exact_in_float32_is_computed_in_float32() -> None:
    got = exact_intervals(2e6, 0, 5000, 100, np.float32)
    assert got.dtype == np.float32
    expected = [float(np.float32(2e6) / np.sqrt(np.float32(10000) * np.float32(i))) for i in range(1, 101)]
    np.testing.assert_array_equal(got, np.array(expected, np.float32))


def test_initial_and_slew_interval_are_formulas_17_and_18() -> None:
    assert initial_interval(1e6, 100, 4000) == pytest.approx(1e6 / 18000**0.5, rel=1e-15)
    assert initial_interval(1e6, 0, 5000) == 10_000
    assert slew_interval(1e6, 2000) == 500


@pytest.mark.parametrize(
    ("base", "slew", "acceleration", "steps"),
    [(0, 1000, 5000, 100), (0, 2000, 4000, 500), (100, 2000, 4000, 498), (0, 10, 1000, 0), (5, 5, 1, 0)],
)
def test_ramp_length_is_formula_16_rounded_down(base: float, slew: float, acceleration: float, steps: int) -> None:
    assert ramp_steps(base, slew, acceleration) == steps


@given(speeds, speeds, accelerations)
def test_no_interval_of_a_ramp_is_shorter_than_at_slew_speed(one: float, other: float, acceleration: float) -> None:
    base, slew = sorted((one, other))
    steps = min(ramp_steps(base, slew, acceleration), 1000)
    intervals = exact_intervals(1e6, base, acceleration, ramp_steps(base, slew, acceleration) if steps < 1000 else 1000)
    assert np.all(intervals >= 1e6 / slew * (1 - 1e-12))
