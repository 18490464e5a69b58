"""What goes over the wire to a Tic, and what it is told of a design."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.tic.emulator import crc_7
from designs import design
from stepramp.controllers.tic.ramp import TicRamp
from stepramp.controllers.tic.wire import Quick, Read, Write, crc7, quick, read, write
from stepramp.errors import Rejected


@pytest.mark.parametrize(
    ("command", "sent"),
    [
        # The examples of the User's Guide, section 9.
        (quick(Quick.HALT_AND_HOLD), "89"),
        (write(Write.TARGET_POSITION, 1_234_567_890), "e0 05 52 02 16 49"),
        (read(Read.VARIABLES, 0x0A, 4), "a1 0a 04"),
        (write(Write.MAX_SPEED, 20_000_000), "e6 00 00 2d 31 01"),
        (write(Write.TARGET_POSITION, -1), "e0 0f 7f 7f 7f 7f"),
    ],
)
def test_commands_as_bytes(command: bytes, sent: str) -> None:
    assert command.hex(" ") == sent


@given(st.integers(-(2**31), 2**31 - 1))
def test_values_arrive_whole_in_bytes_of_seven_bits(value: int) -> None:
    _, top, *low = write(Write.TARGET_VELOCITY, value)
    assert top < 16
    assert max(low) < 128
    arrived = sum((byte + 128 * (top >> place & 1)) * 256**place for place, byte in enumerate(low))
    assert (arrived - value) % 2**32 == 0


def test_the_guide_s_crc() -> None:
    assert crc7(bytes([0x83, 0x01])) == 0x17


@given(st.binary(max_size=20))
def test_crcs_are_the_remainder_of_a_long_division(message: bytes) -> None:
    assert crc7(message) == crc_7(message)


def units(**changes: float) -> tuple[int, int, int, int]:
    ramp = TicRamp.of(design(**{f"ramp__{name}": value for name, value in changes.items()}))
    return ramp.starting_speed, ramp.max_speed, ramp.max_deceleration, ramp.max_acceleration


def test_a_design_s_ramp_in_the_tic_s_units() -> None:
    """Speeds in 1/10,000 steps/s, accelerations in 1/100 steps/s²; without a deceleration the acceleration holds."""
    assert units() == (0, 10_000_000, 500_000, 500_000)
    changed = units(base_speed_steps_per_s=12.5, deceleration_steps_per_s2=1)
    assert changed == (125_000, 10_000_000, 100, 500_000)


@given(st.decimals("0.001", "50000", places=7), st.decimals("1", "21474836.47", places=4))
def test_figures_are_rounded_down_and_never_further_than_one_unit(speed: object, rate: object) -> None:
    _, fastest, deceleration, acceleration = units(
        slew_speed_steps_per_s=float(str(speed)), acceleration_steps_per_s2=float(str(rate))
    )
    assert 0 <= Fraction(str(speed)) * 10_000 - fastest < 1
    assert 0 <= Fraction(str(rate)) * 100 - acceleration < 1
    assert deceleration == acceleration


@pytest.mark.parametrize("figure", [0.29, 4.35, 1234.5678, 0.0007 + 1])
def test_what_people_type_is_not_rounded_twice(figure: float) -> None:
    assert units(slew_speed_steps_per_s=figure)[1] == Fraction(str(figure)) * 10_000


@pytest.mark.parametrize(
    ("changes", "field", "allowed"),
    [
        ({"slew_speed_steps_per_s": 50_000.5}, "ramp.slew_speed_steps_per_s", "at most 50,000 steps/s with a Tic"),
        (
            {"acceleration_steps_per_s2": 0.99},
            "ramp.acceleration_steps_per_s2",
            "a number from 1 to 21,474,836.47 ",
        ),
        (
            {"acceleration_steps_per_s2": 3e7},
            "ramp.acceleration_steps_per_s2",
            "a number from 1 to 21,474,836.47 ",
        ),
        (
            {"deceleration_steps_per_s2": 0.5},
            "ramp.deceleration_steps_per_s2",
            "a number from 1 to 21,474,836.47 ",
        ),
    ],
)
def test_what_is_beyond_a_tic_is_rejected_by_its_field(changes: dict[str, float], field: str, allowed: str) -> None:
    with pytest.raises(Rejected) as caught:
        units(**changes)
    [rejection] = caught.value.rejections
    assert (rejection.field, rejection.value) == (field, next(iter(changes.values())))
    assert rejection.allowed.startswith(allowed)


def test_each_field_that_is_beyond_a_tic_is_named() -> None:
    both = {"base_speed_steps_per_s": 60_000, "slew_speed_steps_per_s": 70_000, "acceleration_steps_per_s2": 0.5}
    with pytest.raises(Rejected) as caught:
        TicRamp.of(design(**{f"ramp__{name}": value for name, value in both.items()}), "axes.0.")
    assert [each.field for each in caught.value.rejections] == [f"axes.0.ramp.{name}" for name in both]


@given(st.floats(0, 2000), st.floats(0, 1000))
def test_slowing_down_takes_as_many_steps_as_its_energy(speed: float, start: float) -> None:
    """(v² - v0²) / (2 d), and at most one more, so that a step isn't cut."""
    ramp = TicRamp(int(start * 10_000), 20_000_000, 123_400, 500_000)
    exact = max(Fraction(0), (Fraction(speed) ** 2 - Fraction(int(start * 10_000), 10_000) ** 2) / (2 * 1234))
    assert exact - Fraction(1, 10**6) <= ramp.steps_to_rest(speed) < exact + 1 + Fraction(1, 10**6)
    assert ramp.steps_to_rest(-speed) == ramp.steps_to_rest(speed)
