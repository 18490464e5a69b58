import pytest

from designs import design
from stepramp.ramp.profile import profile_of
from stepramp.ramp.timer_limits import slew_resolution


def test_an_interval_wider_than_the_counter_says_what_to_change() -> None:
    [warning] = profile_of(design(timer__frequency_hz=16e6)).warnings
    assert warning.field == "timer.counter_bits"
    assert "160,000 ticks" in warning.message
    assert "use 18 bits" in warning.message


def test_an_interval_shorter_than_the_controller_needs_says_what_to_change() -> None:
    [warning] = profile_of(design(timer__shortest_interval_us=1500)).warnings
    assert warning.field == "timer.shortest_interval_us"
    assert "at most 667 steps/s" in warning.message


def test_speeds_that_the_timer_can_make_near_the_slew_speed() -> None:
    # F / v = 1e6 / 30,000 = 33.33 ticks: 33 ticks are 30,303 steps/s, 34 ticks 29,412.
    resolution = slew_resolution(1e6 / 30_000, 1e6)
    assert resolution.relative == pytest.approx(0.03)
    assert resolution.speed_below_steps_per_s == pytest.approx(29_411.76, abs=0.01)
    assert resolution.speed_above_steps_per_s == pytest.approx(30_303.03, abs=0.01)
    assert slew_resolution(0.7, 1e6).speed_above_steps_per_s is None


def test_a_coarse_slew_speed_names_its_neighbours() -> None:
    fast = design(timer__frequency_hz=1e6, ramp__slew_speed_steps_per_s=30_000, ramp__acceleration_steps_per_s2=1e6)
    [warning] = profile_of(fast).warnings
    assert warning.field == "timer.frequency_hz"
    assert "One tick is 3.0 % of the slew interval" in warning.message
    assert "29,412 and 30,303 steps/s" in warning.message
    assert "at least 3,000,000 Hz" in warning.message


def test_a_slew_speed_of_whole_ticks_needs_no_other() -> None:
    fast = design(timer__frequency_hz=1e6, ramp__slew_speed_steps_per_s=20_000, ramp__acceleration_steps_per_s2=1e6)
    [warning] = profile_of(fast).warnings
    assert "Speeds near the slew speed are 2.0 % apart" in warning.message
    assert "Use one of them" not in warning.message


@pytest.mark.parametrize("which", ["acceleration", "deceleration"])
def test_an_acceleration_that_needs_no_step_is_told(which: str) -> None:
    harsh = design(ramp__slew_speed_steps_per_s=100, **{f"ramp__{which}_steps_per_s2": 6000})
    [warning] = [each for each in profile_of(harsh).warnings if each.field == f"ramp.{which}_steps_per_s2"]
    assert "would reach 110 steps/s" in warning.message
    assert "Use at most 5,000 steps/s²" in warning.message


def test_a_sound_design_has_no_warnings() -> None:
    assert profile_of(design()).warnings == ()
