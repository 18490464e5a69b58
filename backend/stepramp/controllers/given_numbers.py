"""Numbers as controllers are given them: decimal texts, which each keeps in its own way."""

import math
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction

import numpy as np

from stepramp.design import AxisScale

ROUNDED = Fraction(1, 2**23)
"""So much of a number a C float takes off at most, and less."""
FLOAT_MAX = float(np.finfo(np.float32).max)
Kept = Callable[[str], Fraction]
"""What a controller makes of a decimal text."""


def typed(value: float) -> Fraction:
    """Return the decimal number that people typed.

    >>> typed(0.29)
    Fraction(29, 100)
    """
    return Fraction(Decimal(str(value)))


def as_float32(text: str) -> Fraction:
    """Return what a controller keeps of a text in a C float; OverflowError for what is beyond one."""
    if abs(float(text)) > FLOAT_MAX:
        raise OverflowError(f"{text} is no float")
    return Fraction(float(np.float32(text)))


def rounded_down(most: Fraction, decimals: int, kept: Kept = Fraction) -> str:
    """Return the greatest number of so many decimals that is kept as no more than so much, from 0.

    >>> rounded_down(Fraction(2, 3), 3), rounded_down(Fraction(250), 3)
    ('0.666', '250')
    """
    # Further up: what is kept may be less than what is written, by as much as float32 rounds.
    scaled = math.floor(most * 10**decimals * (1 + ROUNDED)) + 1
    while scaled > 0 and kept(_text(scaled, decimals)) > most:
        # One less may be the same number yet where a float's own steps are wider.
        scaled -= max(1, math.floor((kept(_text(scaled, decimals)) - most) * 10**decimals))
    return _text(scaled, decimals)


def nearest(value: Fraction, decimals: int) -> str:
    """Return a number with so many decimals, the nearest.

    >>> nearest(Fraction(200, 360), 4)
    '0.5556'
    """
    return _text(round(value * 10**decimals), decimals)


def may_be_told(text: str, value: float) -> bool:
    """Tell whether a number that a controller keeps in a C float may be told so; ValueError for a text that is none.

    >>> may_be_told("8.889", 8.8888889), may_be_told("8.88", 8.8888889)
    (True, False)
    """
    last_place = 10.0 ** -len(text.partition(".")[2])
    return abs(float(text) - value) <= last_place / 2 + abs(value) * float(ROUNDED)


def no_less(exactly: Fraction) -> float:
    """Return the least float that is written as no less: what is rounded down again becomes what it was."""
    value = float(exactly)
    while typed(value) < exactly:
        value = math.nextafter(value, math.inf)
    return value


def steps_per_unit(axis: AxisScale) -> Fraction:
    """Return the steps of an axis for each mm of its travel, or for each degree, which then stands for a mm."""
    return Fraction(axis.steps_per_rev) / typed(axis.travel_per_rev)


def _text(scaled: int, decimals: int) -> str:
    digits = str(scaled).rjust(decimals + 1, "0")
    if decimals == 0:
        return digits
    return f"{digits[:-decimals]}.{digits[-decimals:]}".rstrip("0").rstrip(".")
