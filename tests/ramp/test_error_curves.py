from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from designs import design
from stepramp.errors import Rejected
from stepramp.methods import METHODS
from stepramp.ramp.error_curves import error_curves


def test_exact_against_itself_is_off_by_rounding_alone() -> None:
    judged = error_curves(design(), "exact", "exact")
    assert np.all(np.abs(judged.tick_error) <= 0.5)
    assert abs(judged.largest_relative_error.value) < 0.5 / 2000


def test_formula_20_from_rest_is_29_percent_short_at_step_2() -> None:
    judged = error_curves(design(move__steps=200, ramp__deceleration_steps_per_s2=1e6), "first_order", "exact")
    assert judged.largest_relative_error.step == 2
    assert judged.largest_relative_error.value == pytest.approx(0.5 / 0.5**0.5 - 1, abs=1e-3)
    assert judged.tick_error[1] == pytest.approx(10_000 - 20_000 / 2**0.5, abs=0.51)


def test_the_gauge_table_is_up_to_80_percent_off_a_constant_acceleration() -> None:
    # v0 200, v 1666, a 8000: the ramp for which the published table was measured.
    gauge = design(
        timer__frequency_hz=1e6, ramp__base_speed_steps_per_s=200, ramp__slew_speed_steps_per_s=1666,
        ramp__acceleration_steps_per_s2=8000, move__steps=1000,
    )  # fmt: skip
    judged = error_curves(gauge, "table", "exact")
    own = 1e6 / np.sqrt(200**2 + 2 * 8000 * np.arange(1, 172))
    np.testing.assert_allclose(judged.relative_error[:9], 5000 / own[:9] - 1)
    assert judged.relative_error.max() > 0.8


def test_a_table_is_needed_to_compare_one() -> None:
    with pytest.raises(Rejected, match=r"table is missing"):
        error_curves(design(table=None), "table", "exact")


def test_every_step_has_an_error() -> None:
    for steps in (1, 2, 77, -500):
        for method in ("exact", "first_order", "table"):
            assert error_curves(design(move__steps=steps), method, "exact").relative_error.size == abs(steps)


@given(
    method=st.sampled_from(list(METHODS)),
    arithmetic=st.sampled_from(["float32", "float64"]),
    rounding=st.sampled_from(["nearest", "floor", "carry"]),
    bound=st.none() | st.integers(0, 20),
    steps=st.integers(1, 700),
)
def test_the_parts_add_up_to_the_whole(
    method: str, arithmetic: str, rounding: str, bound: int | None, steps: int
) -> None:
    planned = design(
        method__name=method, method__arithmetic=arithmetic, method__rounding=rounding, move__steps=steps,
        ramp__deceleration_steps_per_s2=7000,
    )  # fmt: skip
    judged = error_curves(planned, method, "exact", bound)
    parts = judged.parts
    whole = parts.method + parts.arithmetic + parts.rounding + parts.compression
    np.testing.assert_allclose(whole, judged.tick_error, rtol=0, atol=1e-6)
    assert np.abs(parts.rounding).max() <= 1.000001
    assert np.abs(parts.arithmetic).max() < 1
    if bound is None:
        assert not parts.compression.any()


def test_curves_against_a_computation_in_plain_python() -> None:
    judged = error_curves(design(move__steps=40), "first_order", "ideal")
    p, r = judged.played_ticks.tolist(), judged.reference_ticks.tolist()
    v = [2e6 / each for each in p]
    assert judged.speed_error_steps_per_s == pytest.approx([2e6 / a - 2e6 / b for a, b in zip(p, r, strict=True)])
    assert judged.time_error_s == pytest.approx([(sum(p[: n + 1]) - sum(r[: n + 1])) / 2e6 for n in range(40)])
    squares = [0.0, *(each**2 for each in v)]
    expected = [(b - a) / 2 for a, b in pairwise(squares)]
    assert judged.implied_acceleration_steps_per_s2 == pytest.approx(expected)
    assert judged.time_difference_s == pytest.approx((sum(p) - sum(r)) / 2e6)
    assert judged.landing_error_steps_per_s == pytest.approx(v[-1])
    rms = (sum((a / b - 1) ** 2 for a, b in zip(p, r, strict=True)) / 40) ** 0.5
    assert judged.rms_relative_error == pytest.approx(rms)
    peak = max(range(1, 40), key=lambda n: abs(expected[n]))
    assert (judged.peak_acceleration.step, judged.peak_acceleration.value) == (peak + 1, pytest.approx(expected[peak]))


def test_a_move_that_is_quicker_is_ahead() -> None:
    judged = error_curves(design(move__steps=300), "first_order", "exact")
    assert judged.position_lag_steps[50] < 0
    assert judged.time_error_s[50] < 0
    # When its 51st interval ends, the reference has made as many steps fewer as it is behind.
    end, reference_ends = judged.played_ticks[:51].sum(), np.cumsum(judged.reference_ticks)
    done = np.interp(end, reference_ends, np.arange(1, 301))
    assert judged.position_lag_steps[50] == pytest.approx(done - 51)


def test_exact_implies_its_own_acceleration() -> None:
    judged = error_curves(design(timer__frequency_hz=100e6, move__steps=150), "exact", "exact")
    np.testing.assert_allclose(judged.implied_acceleration_steps_per_s2[1:70], 5000, rtol=0.01)


def test_formula_20_lands_fast_and_a_table_waits() -> None:
    # From rest (20) decelerates too little, and its last interval is shorter than p1.
    slow, fast = design(move__steps=400), error_curves(design(move__steps=400), "first_order", "exact")
    base_landing = error_curves(slow, "exact", "exact").landing_error_steps_per_s
    assert base_landing == pytest.approx(100)
    assert fast.landing_error_steps_per_s > 1.5 * base_landing
    # The table's slowest row ends a move: ramp indices 10 to 0, one of them the last step itself.
    assert error_curves(design(), "table", "exact").waiting_steps == 10
    assert error_curves(slow, "exact", "exact").waiting_steps == 0


def test_playing_from_segments_stays_within_their_bound() -> None:
    for bound in (0, 1, 5):
        judged = error_curves(design(), "exact", "exact", bound)
        assert np.abs(judged.parts.compression).max() <= bound
        assert (bound == 0) == (not judged.parts.compression.any())


FAST_AND_GENTLE = {
    "ramp__slew_speed_steps_per_s": 20_000,
    "ramp__acceleration_steps_per_s2": 2000,
    "move__steps": 210_000,
}


@pytest.mark.parametrize("rounding", ["nearest", "floor", "carry"])
def test_what_rounding_makes_of_an_acceleration_is_not_the_ramp(rounding: str) -> None:
    """By (4) v² grows by 2 a a step: all accelerations are a, however coarse the ticks that they are played in."""
    judged = error_curves(design(**FAST_AND_GENTLE, method__rounding=rounding), "exact", "exact")
    # Near full speed an interval is 100 or 101 ticks of 2 MHz: one step between them is (v² - v'²) / 2.
    one_tick = (Fraction(2_000_000, 100) ** 2 - Fraction(2_000_000, 101) ** 2) / 2
    assert abs(judged.peak_acceleration.value) == pytest.approx(float(one_tick))
    assert one_tick > 1900 * 2000
    assert abs(judged.peak_ramp_acceleration.value) == pytest.approx(2000, rel=1e-6)


@pytest.mark.parametrize("arithmetic", ["float32", "float64", "fixed"])
def test_what_the_method_does_is_the_ramp(arithmetic: str) -> None:
    """Formula (20) from rest: q = a p1² / F² is 1/2, so p2 is p1 / 2, and v2² - v1² is 8 a - 2 a."""
    wanted = design(**FAST_AND_GENTLE, method__name="first_order", method__arithmetic=arithmetic)
    peak = error_curves(wanted, "first_order", "exact").peak_ramp_acceleration
    assert (peak.value, peak.step) == (pytest.approx(3 * 2000, rel=1e-5), 2)


@given(
    delays=st.lists(st.integers(100, 20_000), min_size=1, max_size=6),
    lengths=st.lists(st.integers(1, 5), min_size=6, max_size=6),
    steps=st.integers(1, 80),
)
def test_the_jumps_of_a_table_are_its_own(delays: list[int], lengths: list[int], steps: int) -> None:
    rows, last = [], -1
    for delay, length in zip(sorted(delays, reverse=True), lengths, strict=False):
        last += length
        rows.append([last, delay])
    wanted = design(table={"rows": rows, "interval_unit": "us"}, move__steps=steps, timer__frequency_hz=1000.5e3)
    judged = error_curves(wanted.with_method("table"), "table", "table")
    squares = [Fraction(0), *((Fraction(1_000_500) / Fraction(each)) ** 2
                              for each in judged.profile.plan.real_intervals.tolist())]  # fmt: skip
    jumps = [float(after - before) / 2 for before, after in pairwise(squares)]
    counted = jumps[1:] or jumps
    peak = judged.peak_ramp_acceleration
    assert abs(peak.value) == pytest.approx(max(map(abs, counted)), rel=1e-9, abs=1e-3)
    assert jumps[peak.step - 1] == pytest.approx(peak.value, rel=1e-9, abs=1e-3)
