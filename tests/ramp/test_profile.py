import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from designs import design
from stepramp.errors import Rejected
from stepramp.ramp.profile import Phase, profile_of


def test_exact_profile_of_the_lead_screw_stage() -> None:
    profile = profile_of(design(move__steps=500))
    i = np.arange(1, 101)
    ramp = np.floor(2e6 / np.sqrt(2 * 5000 * i) + 0.5)
    np.testing.assert_array_equal(profile.intervals_ticks, np.concatenate((ramp, np.full(300, 2000), ramp[::-1])))
    assert profile.phases == (Phase("accelerate", 1, 100), Phase("slew", 101, 400), Phase("decelerate", 401, 500))
    assert profile.time_s[0] == 0
    np.testing.assert_allclose(np.diff(profile.time_s), profile.intervals_ticks[:-1] / 2e6, rtol=1e-9)
    assert profile.duration_s == pytest.approx(profile.intervals_ticks.sum() / 2e6, rel=1e-15)
    assert profile.speed_steps_per_s.max() == 1000
    assert profile.warnings == ()


def test_a_short_move_never_reaches_slew_speed() -> None:
    profile = profile_of(design(move__steps=50))
    assert profile.phases == (Phase("accelerate", 1, 25), Phase("decelerate", 26, 50))
    assert profile.intervals_ticks.min() == round(2e6 / (2 * 5000 * 25) ** 0.5)
    assert [warning.field for warning in profile.warnings] == ["move.steps"]
    assert "500 steps/s" in profile.warnings[0].message


def test_a_faster_deceleration_takes_fewer_steps() -> None:
    profile = profile_of(design(ramp__deceleration_steps_per_s2=20_000, move__steps=1000))
    assert [profile.steps_of(name) for name in ("accelerate", "slew", "decelerate")] == [100, 875, 25]
    assert profile.intervals_ticks[-1] == round(2e6 / (2 * 20_000) ** 0.5)


def test_a_short_move_with_two_accelerations_peaks_where_both_speeds_are_equal() -> None:
    profile = profile_of(design(ramp__deceleration_steps_per_s2=20_000, move__steps=50))
    assert [profile.steps_of(name) for name in ("accelerate", "slew", "decelerate")] == [40, 0, 10]


COSINE = {"schema": "stepramp/2", "method__name": "exact", "ramp__shape": {"name": "cosine"}}


def test_a_move_too_short_for_full_speed_is_told_a_length_that_would_do() -> None:
    # Both sides are pi v² / 4 a = 157.08 steps long, 314.16 together.
    [warning] = profile_of(design(**COSINE, move__steps=314)).warnings
    assert "which takes 315 steps" in warning.message
    assert profile_of(design(**COSINE, move__steps=315)).warnings == ()


@pytest.mark.parametrize("points", [[[0, 1], [990, 1], [1000, 0.001]], [[0, 0.001], [1000, 1]]])
def test_of_a_ramp_of_less_than_a_step_no_speed_beyond_it_is_told(points: list[list[float]]) -> None:
    drawn = {"name": "drawn", "points": points}
    given = design(schema="stepramp/2", method__name="exact", ramp__shape=drawn, ramp__acceleration_steps_per_s2=1e9)
    messages = [warning.message for warning in profile_of(given).warnings if "there is no ramp" in warning.message]
    assert all("the whole ramp would take less than one step" in message for message in messages)
    assert messages


def test_what_is_too_gentle_for_want_of_a_deceleration_is_the_acceleration() -> None:
    shape = {"name": "s_curve", "jerk_steps_per_s3": 1e9, "deceleration_jerk_steps_per_s3": 10_500}
    long = design(
        schema="stepramp/2", method__name="exact", ramp__shape=shape, ramp__slew_speed_steps_per_s=1e6,
        ramp__acceleration_steps_per_s2=66_667, move={"steps": 100, "plan": "any_move"},
    )  # fmt: skip
    with pytest.raises(Rejected) as caught:
        profile_of(long)
    assert [each.field for each in caught.value.rejections] == ["ramp.acceleration_steps_per_s2"]


def test_a_negative_move_is_the_same_backwards() -> None:
    forward, back = profile_of(design(move__steps=70)), profile_of(design(move__steps=-70))
    np.testing.assert_array_equal(forward.intervals_ticks, back.intervals_ticks)
    np.testing.assert_array_equal(forward.position_steps, -back.position_steps)
    assert back.position_steps[-1] == -70


def test_one_step() -> None:
    profile = profile_of(design(move__steps=1))
    assert profile.intervals_ticks.tolist() == [20_000]
    assert profile.time_s.tolist() == [0]


def test_base_speed_equal_to_slew_speed_is_a_move_without_ramp() -> None:
    profile = profile_of(design(ramp__base_speed_steps_per_s=1000, move__steps=10))
    assert profile.phases == (Phase("slew", 1, 10),)


def test_formula_20_lands_faster_than_it_started() -> None:
    # Backwards, formula (20) amplifies its error: the last interval is shorter than the first.
    profile = profile_of(design(method__name="first_order", method__arithmetic="float32"))
    assert profile.intervals_ticks[0] == 20_000
    assert profile.intervals_ticks[-1] < 15_000


def test_halves_are_rounded_up() -> None:
    # p_S = 1e6 / 160000 = 6.25 and 1e6 / 400000 = 2.5 ticks.
    fast = design(timer__frequency_hz=1e6, ramp__slew_speed_steps_per_s=400_000, ramp__acceleration_steps_per_s2=1e9)
    assert profile_of(fast).intervals_ticks.min() == 3


@pytest.mark.parametrize("which", ["acceleration", "deceleration"])
def test_a_ramp_longer_than_any_move_is_refused_before_it_is_made(which: str) -> None:
    with pytest.raises(Rejected) as caught:
        profile_of(design(**{f"ramp__{which}_steps_per_s2": 0.01}))
    [rejection] = caught.value.rejections
    assert (rejection.field, rejection.value) == (f"ramp.{which}_steps_per_s2", 0.01)
    assert "at least 0.05 steps/s²" in rejection.allowed


def test_an_interval_of_no_ticks_is_refused() -> None:
    with pytest.raises(Rejected) as caught:
        profile_of(design(timer__frequency_hz=1000, ramp__slew_speed_steps_per_s=3000))
    [rejection] = caught.value.rejections
    assert (rejection.field, rejection.value) == ("ramp.slew_speed_steps_per_s", 3000)
    assert "at most 1,000 steps/s" in rejection.allowed


def test_a_row_of_less_than_a_tick_is_to_blame_itself() -> None:
    # 400 µs are 0.4 ticks of 1,000 Hz, 700 µs 0.7: rounded to the nearest, one of them is no tick.
    rows = {"timer__frequency_hz": 1000, "method__name": "table", "table__rows": [[10, 2000], [20, 700], [30, 400]]}
    for rounding, blamed in (("nearest", [2]), ("floor", [1, 2])):
        with pytest.raises(Rejected) as caught:
            profile_of(design(**rows, method__rounding=rounding))
        told = [(each.field, each.value) for each in caught.value.rejections]
        assert told == [(f"table.rows.{row}.1", rows["table__rows"][row][1]) for row in blamed]
        assert "at least 1,000 µs" in caught.value.rejections[0].allowed
        profile_of(design(**rows | {"table__rows": [[10, 2000], [20, 1000]]}, method__rounding=rounding))


def test_an_interval_of_about_a_tick_is_no_fault_of_the_slew_speed() -> None:
    # At as many steps/s as ticks/s the slew interval is 1 tick, which Newton's method comes to from below.
    even = {"timer__frequency_hz": 1000, "method__name": "newton", "ramp__acceleration_steps_per_s2": 5000}
    with pytest.raises(Rejected, match=r"method.rounding is 'floor'; allowed: nearest"):
        profile_of(design(**even, method__rounding="floor"))
    assert profile_of(design(**even)).intervals_ticks.min() == 1


def test_a_move_of_more_ticks_than_can_be_counted_is_refused() -> None:
    endless = design(
        timer__frequency_hz=1e9, method__name="table", table__rows=[[1, 4_000_000_000]], move__steps=10_000_000
    )
    with pytest.raises(Rejected, match=r"timer.frequency_hz is 1000000000.0; allowed: a lower frequency"):
        profile_of(endless)


@given(
    name=st.sampled_from(["exact", "first_order"]),
    timer=st.floats(1e5, 1e8),
    base=st.just(0.0) | st.floats(0.001, 500),
    gain=st.floats(0, 20_000),
    acceleration=st.floats(100, 1e7),
    deceleration=st.floats(100, 1e7),
    steps=st.integers(-5000, 5000).filter(bool),
)
def test_laws_of_every_profile(
    name: str, timer: float, base: float, gain: float, acceleration: float, deceleration: float, steps: int
) -> None:
    slew = base + gain + 1
    profile = profile_of(
        design(
            method__name=name,
            timer__frequency_hz=timer,
            ramp__base_speed_steps_per_s=base,
            ramp__slew_speed_steps_per_s=slew,
            ramp__acceleration_steps_per_s2=acceleration,
            ramp__deceleration_steps_per_s2=deceleration,
            move__steps=steps,
        )
    )
    assert profile.intervals_ticks.size == abs(steps)
    assert profile.position_steps[-1] == steps
    assert profile.intervals_ticks.min() >= round(timer / slew) - 1
    assert sum(profile.steps_of(name) for name in ("accelerate", "slew", "decelerate")) == abs(steps)
    peak = int(profile.intervals_ticks.argmin())
    assert np.all(np.diff(profile.intervals_ticks[: peak + 1]) <= 0)
    assert np.all(np.diff(profile.intervals_ticks[peak:]) >= 0)
