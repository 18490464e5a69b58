"""Designs of a Tic's settings file."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.bench import only_rejection
from designs import design
from stepramp.controllers.tic.ramp import TicRamp
from stepramp.controllers.tic.read_settings import read_settings
from stepramp.errors import Rejected

AS_NEW = """# Pololu Tic USB Stepper Controller settings file.
# https://www.pololu.com/docs/0J71
product: 36v4
control_mode: serial
command_timeout: 1000
invert_motor_direction: false
max_speed: 2000000
starting_speed: 0
max_accel: 40000
max_decel: 0
step_mode: 32  # thirty-seconds
current_limit: 179
"""
"""Lines of what ticcmd writes of a Tic as it comes, and a comment as its reader takes them."""


def test_a_settings_file_as_ticcmd_writes_it() -> None:
    base = design(axis__microsteps=16, ramp__base_speed_steps_per_s=50)
    [axis] = read_settings(AS_NEW.replace("\n", "\r\n"), base)
    ramp = axis.design.ramp
    assert (ramp.base_speed_steps_per_s, ramp.slew_speed_steps_per_s) == (0, 200)
    assert (ramp.acceleration_steps_per_s2, ramp.deceleration_steps_per_s2) == (400, None)
    assert (axis.design.name, axis.design.axis.microsteps) == ("Tic 36v4", 32)
    assert axis.design.axis.full_steps_per_rev == base.axis.full_steps_per_rev
    assert axis.remarks == ("Full steps of a turn and what it moves are not told: the design's own stay.",)


@given(
    st.just(0) | st.integers(10, 499_000_000),
    st.integers(10, 1_000_000),
    st.integers(100, 2**31 - 1),
    st.integers(100, 2**31 - 1),
)
def test_what_is_read_is_sent_again_to_the_last_unit(start: int, more: int, down: int, up: int) -> None:
    told = TicRamp(start, start + more, down, up)
    text = f"starting_speed: {start}\nmax_speed: {start + more}\nmax_decel: {down}\nmax_accel: {up}\nstep_mode: 8\n"
    [axis] = read_settings(text, design())
    assert TicRamp.of(axis.design) == told
    assert axis.design.axis.microsteps == 8


def test_a_file_that_ends_within_a_number_of_its_ramp_says_so() -> None:
    begun = "product: 36v4\nstep_mode: 8\nmax_accel: 40000\n"
    for cut in ("max_speed: 2000", "max_speed: 2000000\n# in use: max_speed: 2000"):
        [axis] = read_settings(begun + cut, design())
        assert axis.remarks[0] == (
            "The text ends at max_speed: 2000, without a line end: if it was cut off there, that number may lack "
            "digits, and settings that would follow are missing."
        )
    for end in ("max_speed: 2000\n", "max_speed: 2000\r\n", "max_speed: 2000  # slow", "max_speed: 2000\ncurrent: 1"):
        [axis] = read_settings(begun + end, design())
        assert not axis.remarks[0].startswith("The text ends"), end


def test_what_is_left_out() -> None:
    """A Tic has no starting speed then, and slows down as it speeds up; its step mode isn't known."""
    [axis] = read_settings("max_accel: 12345\nmax_speed: 7000000\n", design(axis__microsteps=4))
    assert TicRamp.of(axis.design) == TicRamp(0, 7_000_000, 12_345, 12_345)
    assert axis.design.axis.microsteps == 4
    assert "The step mode is not told" in axis.remarks[0]


@pytest.mark.parametrize("text", ["", "max_speed: 2000000", "[printer]\nmax_velocity: 300\nmax_accel: 3000", "$110=5"])
def test_what_is_no_settings_file(text: str) -> None:
    assert read_settings(text, design()) == []


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (AS_NEW + "max_speed: 0", "With max_speed 0 the slew speed of a Tic is 0; allowed: a number from 0.001 to"),
        (AS_NEW + "starting_speed: 3000000", "With starting_speed 3000000 the base speed of a Tic is 300; allowed: a"),
        (AS_NEW + "max_speed: fast", "max_speed is fast; allowed: whole numbers of a Tic's units."),
        (AS_NEW + "step_mode: 3", "step_mode is 3; allowed: a step mode of a Tic: full, half"),
        ("product: T825\nmax_accel: 40000\nstep_mode: 8", "max_speed isn't there; allowed: a whole settings file of"),
    ],
)
def test_what_makes_no_sense_is_told_by_its_own_name(text: str, said: str) -> None:
    with pytest.raises(Rejected) as refused:
        read_settings(text, design())
    assert str(refused.value).startswith(said)
    assert refused.value.rejections[0].field == "text"


def test_options_of_the_same_names_in_sections_are_no_settings_of_a_tic() -> None:
    text = "[printer]\nmax_accel: 3000\n  [temperature_fan chamber]  # as it came\nmax_speed: 1.0\n"
    assert read_settings(text, design()) == []


@pytest.mark.parametrize(
    ("changes", "value", "words"),
    [
        ("max_speed: fast", "max_speed: fast", "whole numbers of a Tic's units"),
        ("max_accel: 99", "starting_speed: 0, max_speed: 2000000, max_decel: 0, max_accel: 99", "from 100 to"),
        ("step_mode: 3", "step_mode: 3", "a step mode of a Tic: full, half, 2_100p, 1, 2, 4"),
        ("starting_speed: 3000000", 300.0, "settings of a Tic that a design can have"),
        ("max_speed: 0", 0.0, "settings of a Tic that a design can have"),
    ],
)
def test_what_makes_no_sense_is_named(changes: str, value: object, words: str) -> None:
    field, found, allowed = only_rejection(lambda: read_settings(AS_NEW + changes, design()))
    assert (field, found) == ("text", value)
    assert words in allowed
