"""Numbers as grbl reads them: eight digits, float32, and never more than was asked."""

from __future__ import annotations

import struct
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepramp.controllers.grbl.numbers import below, exact, is_same, read, target


def kept(text: str) -> Fraction:
    return exact(read(text))


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("250.000", 250.0), ("0.5", 0.5), ("-12.25", -12.25), ("+7", 7.0), ("0", 0.0), (".25", 0.25), ("4.", 4.0),
        ("1234567890", 1_234_567_800.0),  # what comes after eight digits counts as 0
        ("1.23456789", 1.2345678),
    ],
)  # fmt: skip
def test_reading(text: str, value: float) -> None:
    assert float(read(text)) == pytest.approx(value, rel=3e-7)


@pytest.mark.parametrize("text", ["", ".", "-", "1e5", "nan", "inf", "0x1", "1.2.3", "١"])
def test_what_is_no_number(text: str) -> None:
    with pytest.raises(ValueError, match="no decimal number"):
        read(text)


@given(st.decimals("0.01", "9999999", places=3))
def test_reading_is_right_to_two_places_of_a_float32(value: object) -> None:
    nearest = struct.unpack("<f", struct.pack("<f", float(str(value))))[0]
    # Digits beyond the eighth are dropped: of 1234567.891 the last two.
    assert float(read(str(value))) == pytest.approx(nearest, rel=3 * 2**-23)


@given(st.fractions(Fraction(2, 1000), 99_999_999))
def test_below_is_below_and_near(most: Fraction) -> None:
    text = below(most, kept)
    assert len(text.replace(".", "")) <= 8
    assert kept(text) <= most
    assert float(most - kept(text)) <= 0.0011 + float(most) * 4e-7


@given(st.integers(-2_000_000, 2_000_000), st.sampled_from([5.0, 80.0, 250.0, 314.961, 1600.0]))
def test_a_target_is_the_step(place: int, per_mm: float) -> None:
    text = target(place, np.float32(per_mm))
    assert text is not None
    assert len(text.strip("-").replace(".", "")) <= 8
    # As a machine with exact numbers would have it, less than half a step away; float32 alone costs less than a fifth.
    assert abs(Fraction(text) * Fraction(float(np.float32(per_mm))) - place) < 1


def test_a_target_that_no_number_tells() -> None:
    assert target(2**24 + 1, np.float32(1)) is None
    assert target(2**24 + 1, np.float32(250)) is None
    assert target(10**9, np.float32(5)) is None


def test_telling_the_same() -> None:
    assert is_same(read("16.000"), read("15.9996"))
    assert not is_same(read("16.000"), read("15.999"))
    # 12,345,678.9 has no decimals in a float32.
    assert is_same(read("12345679"), read("12345678"))
    assert not is_same(read("12345679"), read("12345670"))
