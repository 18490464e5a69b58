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
    assert "at most 666.666 steps/s" in warning.message
    assert profile_of(design(timer__shortest_interval_us=1500, ramp__slew_speed_steps_per_s=666.666)).warnings == ()


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
    assert "29,412 steps/s and 30,303 steps/s" in warning.message
    assert [(each.value, each.unit) for each in warning.told] == [
        (pytest.approx(29_411.76, abs=0.01), "steps/s"),
        (pytest.approx(30_303.03, abs=0.01), "steps/s"),
    ]
    assert "at least 3,000,000 Hz" in warning.message


def test_a_slew_speed_of_whole_ticks_needs_no_other() -> None:
    fast = design(timer__frequency_hz=1e6, ramp__slew_speed_steps_per_s=20_000, ramp__acceleration_steps_per_s2=1e6)
    [warning] = profile_of(fast).warnings
    assert "Speeds near the slew speed are 2.0 % apart" in warning.message
    assert "Use one of them" not in warning.message


def no_ramp(**changes: object) -> list[str]:
    """Return what is said of sides without a step."""
    return [each.message for each in profile_of(design(**changes)).warnings if "there is no ramp" in each.message]


@pytest.mark.parametrize("which", ["acceleration", "deceleration"])
def test_an_acceleration_that_needs_no_step_is_told(which: str) -> None:
    harsh = {"ramp__slew_speed_steps_per_s": 100, "ramp__acceleration_steps_per_s2": 5000}
    [warning] = profile_of(design(**harsh | {f"ramp__{which}_steps_per_s2": 6000})).warnings
    assert warning.field == f"ramp.{which}_steps_per_s2"
    # sqrt(2 · 6000) = 109.545; 100² / 2 = 5000.
    assert "would reach 109.545 steps/s" in warning.message
    assert "Use at most 5,000 steps/s², or a slew speed of at least 109.545 steps/s" in warning.message


def test_a_ramp_from_a_base_speed_that_is_shorter_than_a_step_is_told() -> None:
    # (1000² - 900²) / 2 = 95,000 steps/s² is what one step takes; 100,000 lead to sqrt(900² + 200,000) = 1004.99.
    from_base = {"ramp__base_speed_steps_per_s": 900, "ramp__slew_speed_steps_per_s": 1000}
    [message] = no_ramp(**from_base, ramp__acceleration_steps_per_s2=100_000)
    assert "Use at most 95,000 steps/s², or a slew speed of at least 1,004.99 steps/s" in message
    assert no_ramp(**from_base, ramp__acceleration_steps_per_s2=95_000) == []
    assert no_ramp(**from_base | {"ramp__slew_speed_steps_per_s": 1004.99}, ramp__acceleration_steps_per_s2=1e5) == []


def test_where_base_and_slew_speed_are_the_same_no_ramp_is_missing() -> None:
    even = {"ramp__base_speed_steps_per_s": 1000, "ramp__slew_speed_steps_per_s": 1000}
    assert profile_of(design(**even, ramp__acceleration_steps_per_s2=600_000)).warnings == ()


def test_an_acceleration_that_is_none_is_not_advised() -> None:
    slow = {"ramp__slew_speed_steps_per_s": 0.01, "ramp__acceleration_steps_per_s2": 0.001, "timer__counter_bits": 64}
    [message] = no_ramp(**slow, move__steps=1)
    assert "Use a slew speed of at least 0.0447214 steps/s" in message


def test_a_method_that_has_a_step_there_has_a_ramp() -> None:
    # 100² / 12,000 = 0.83 steps: the centre of the first lies before the end of the slope.
    half = {"ramp__slew_speed_steps_per_s": 100, "ramp__acceleration_steps_per_s2": 6000}
    assert profile_of(design(method__name="midpoint", **half)).steps_of("accelerate") == 1
    assert no_ramp(method__name="midpoint", **half) == []


def test_a_sound_design_has_no_warnings() -> None:
    assert profile_of(design()).warnings == ()
