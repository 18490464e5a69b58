"""Numbers as grbl 1.1 reads and keeps them: at most eight digits count, in float32."""

import math
from collections.abc import Callable
from fractions import Fraction

import numpy as np

MOST_DIGITS = 8
"""Further digits it drops."""
LONGEST = 24
"""What has more characters is no number that anybody tells: grbl has ten digits before the point, and four after it."""
DECIMALS = 3
"""Of the numbers that it tells."""
ROUNDED = Fraction(1, 2**21)
"""So much of a number its float32 arithmetic takes off at most, and less."""
ULPS = 4
"""So far apart two float32 may be that went through its arithmetic [units in the last place]."""


def read(text: str) -> np.float32:
    """Return what grbl makes of a decimal number without exponent, such as -0.125: its digits are scaled in float32.

    Raises ValueError for what isn't one.
    """
    digits, exponent, seen, is_decimal = 0, 0, 0, False
    unsigned = text[1:] if text[:1] in ("-", "+") else text
    if len(unsigned) > LONGEST or not unsigned.replace(".", "", 1).isdigit() or not unsigned.isascii():
        raise ValueError(f"{text!r} is no decimal number")
    for character in unsigned:
        if character == ".":
            is_decimal = True
            continue
        seen += 1
        if seen <= MOST_DIGITS:
            digits, exponent = digits * 10 + int(character), exponent - is_decimal
        else:
            exponent += not is_decimal
    value = np.float32(digits)
    while exponent <= -2 and value:
        value, exponent = value * np.float32(0.01), exponent + 2
    if exponent < 0:
        value *= np.float32(0.1)
    while exponent > 0 and value:
        value, exponent = value * np.float32(10), exponent - 1
    return -value if text.startswith("-") else value


def below(most: Fraction, kept: Callable[[str], Fraction]) -> str:
    """Return the greatest number of up to three decimals and eight digits that grbl keeps as no more than so much.

    most: of at most eight digits before the point. kept: what it makes of a number.
    """
    whole = len(str(math.floor(most)))
    decimals = min(DECIMALS, MOST_DIGITS - whole)
    # Further up: what is kept may be a little less than what is written.
    scaled = min(math.floor(most * 10**decimals * (1 + ROUNDED)) + 1, 10 ** (whole + decimals) - 1)
    while scaled > 0 and kept(_text(scaled, decimals)) > most:
        scaled -= 1
    return _text(scaled, decimals)


def target(steps: int, steps_per_mm: np.float32) -> str | None:
    """Return the number of mm that grbl takes for a position [steps]; None when no number of eight digits is one."""
    length = Fraction(steps) / exact(steps_per_mm)
    whole = len(str(math.floor(abs(length))))
    if whole > MOST_DIGITS:
        return None
    decimals = MOST_DIGITS - whole
    text = _text(round(length * 10**decimals), decimals)
    # As it works a target out: the product in float32, and that rounded.
    reached = float(read(text) * steps_per_mm)
    return text if math.floor(abs(reached) + 0.5) == abs(steps) else None


def is_same(told: np.float32, meant: np.float32) -> bool:
    """Tell whether a number that grbl tells may be one that it was given."""
    slack = 0.5 * 10.0**-DECIMALS + ULPS * float(np.spacing(np.maximum(abs(told), abs(meant))))
    return abs(float(told) - float(meant)) <= slack


def exact(value: np.float32) -> Fraction:
    """Return a float32 as it is."""
    return Fraction(float(value))


def _text(scaled: int, decimals: int) -> str:
    sign, digits = "-" if scaled < 0 else "", str(abs(scaled)).rjust(decimals + 1, "0")
    return f"{sign}{digits[:-decimals]}.{digits[-decimals:]}" if decimals else f"{sign}{digits}"
