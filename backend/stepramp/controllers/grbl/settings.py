"""The settings of a grbl, as it lists them after `$$`: a number each."""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol

import numpy as np

from stepramp.controllers.grbl.numbers import DECIMALS, ULPS, exact, is_same, read
from stepramp.units import SECONDS_PER_MINUTE

STEPS_PER_MM, MOST_RATE, ACCELERATION, TRAVEL = 100, 110, 120, 130
"""Numbers of the settings of the first axis; the next axis has the next numbers."""
OF_AXES = range(STEPS_PER_MM, TRAVEL + 10)
"""All of which grbl lists with the same number of decimals."""
REPORTS_INCHES, SOFT_LIMITS, HOMING, STAYS_ON = 13, 20, 22, 1
LETTERS = "XYZABCUVW"
MM_PER_INCH = 25.4
ROUNDED_STEP = 0.5
"""Whatever is off by so much of a step may be another step."""

_SETTING = re.compile(r"[$](?P<number>\d{1,4})=(?P<value>[^ (]*)(?: *[(].*[)])?")

_PASTED = re.compile(
    r"(?:(?:>+|<+|[$][$]|\[[^\]]*\]|[A-Za-z]\w*:|[\d:.]+)\s+)*[$](?P<number>\d{1,4})\s*=\s*(?P<value>[^\s;(]*)(?:[\s;(].*)?"
)
"""A setting with marks of a console, such as `>>> ` or `[22:10:11] `, before it, and a comment after it."""


@dataclass(frozen=True)
class AxisSettings:
    """What a grbl keeps of one axis, as it has read it."""

    steps_per_mm: np.float32
    most_rate: np.float32
    """[mm/min]"""
    acceleration: np.float32
    """[mm/s²]"""
    slack_per_mm: float = 0.0
    """So much more, or less, its steps per mm may be than it tells, since it rounds them."""

    @property
    def most_steps_per_mm(self) -> np.float32:
        """As many as they may be: rounded, and read in float32 arithmetic."""
        if not self.slack_per_mm:
            return self.steps_per_mm
        return np.float32(float(self.steps_per_mm) + self.slack_per_mm + ULPS * float(np.spacing(self.steps_per_mm)))

    @property
    def rounding_words(self) -> str | None:
        """What comes of it that its steps per mm are rounded, as a sentence; None where they aren't."""
        if not self.slack_per_mm:
            return None
        way_mm = ROUNDED_STEP / self.slack_per_mm
        return (
            f"{float(self.steps_per_mm):,.7g} steps/mm are told rounded: speeds and accelerations are worked out with "
            f"the {float(self.steps_per_mm) + self.slack_per_mm:,.7g} that they may be. Further than {way_mm:,.7g} mm, "
            f"{round(way_mm * float(self.steps_per_mm)):,} steps, from where the controller counts from, places "
            "may be off by a step or more."
        )

    @property
    def speed_steps_per_s(self) -> float:
        """Its highest speed [steps/s]."""
        return float(speed_of(self.most_rate, self.steps_per_mm))

    @property
    def acceleration_steps_per_s2(self) -> float:
        """How it gains speed, and loses it [steps/s²]."""
        return float(acceleration_of(self.acceleration, self.steps_per_mm))


class Known(Protocol):
    """What is known of how a controller is set, whatever tells it."""

    def axis(self, axis: int) -> AxisSettings | None:
        """Return what is kept of an axis; None when it isn't there, or makes no sense."""

    def number(self, number: int) -> float:
        """Return what grbl has as a setting of this number; 0 where it isn't there, or is none."""

    def scale_name(self, axis: int) -> str:
        """Return what the controller calls the steps per mm of an axis."""


@dataclass(frozen=True)
class CutOff:
    """A setting whose last figures are missing."""

    number: int
    value: str
    decimals: int
    """So many the others have."""


@dataclass(frozen=True)
class Settings:
    """All of a listing, by number, as texts."""

    values: Mapping[int, str]

    @classmethod
    def of(cls, lines: Iterable[str]) -> "Settings":
        """Return the settings that lines tell; other lines are left out."""
        found = (_SETTING.fullmatch(line.strip()) for line in lines)
        return cls({int(each["number"]): each["value"] for each in found if each is not None})

    @classmethod
    def pasted(cls, lines: Iterable[str]) -> "Settings":
        """Return the same of lines as people copy them, with what their programs put around them."""
        return cls(dict(_pasted(lines)))

    @staticmethod
    def told_twice(lines: Iterable[str]) -> list[str]:
        """Return what such lines list more than once, with different values, as they are listed."""
        listed: dict[int, dict[str, None]] = {}
        for number, value in _pasted(lines):
            listed.setdefault(number, {})[value] = None
        return [
            " and ".join(f"${number}={value}" for value in each) for number, each in listed.items() if len(each) > 1
        ]

    @staticmethod
    def cut_off(lines: Iterable[str]) -> "CutOff | None":
        """Return the setting of an axis that ends such lines with fewer decimals than all others of axes have.

        None where the last has as many, and where the others differ: a person has written them.
        """
        listed = [line.strip() for line in lines if line.strip()]
        found = _PASTED.fullmatch(listed[-1]) if listed else None
        if found is None or int(found["number"]) not in OF_AXES or found.end("value") < len(listed[-1]):
            return None
        others = {_decimals(value) for number, value in _pasted(listed[:-1]) if number in OF_AXES}
        if len(others) != 1 or _decimals(found["value"]) >= (decimals := others.pop()):
            return None
        return CutOff(int(found["number"]), found["value"], decimals)

    def missing(self, axis: int) -> list[str]:
        """Return the names of settings that an axis lacks, of which another one is there."""
        numbers = [first + axis for first in (STEPS_PER_MM, MOST_RATE, ACCELERATION)]
        missing = [f"${number}" for number in numbers if number not in self.values]
        return missing if len(missing) < len(numbers) else []

    def axis(self, axis: int) -> AxisSettings | None:
        """Return what is kept of an axis; None when it isn't there, or makes no sense."""
        try:
            values = [read(self.values[first + axis]) for first in (STEPS_PER_MM, MOST_RATE, ACCELERATION)]
        except (KeyError, ValueError):
            return None
        if not all(_makes_sense(each) for each in values):
            return None
        scale, rate, gain = values
        return AxisSettings(scale, rate, gain, rounding_slack(self.values[STEPS_PER_MM + axis]))

    def senseless(self, axis: int) -> str | None:
        """Return the first setting of an axis that is all there which keeps it from moving, as it is listed."""
        numbers = [first + axis for first in (STEPS_PER_MM, MOST_RATE, ACCELERATION)]
        if not all(number in self.values for number in numbers):
            return None
        return next((f"${number}={self.values[number]}" for number in numbers if not _moves(self.values[number])), None)

    def number(self, number: int) -> float:
        """Return a setting as a number; 0 where it isn't there, or is none."""
        try:
            return float(read(self.values[number]))
        except (KeyError, ValueError):
            return 0.0

    def scale_name(self, axis: int) -> str:
        """Return what grbl calls the steps per mm of an axis."""
        return f"${STEPS_PER_MM + axis}"


def _decimals(value: str) -> int:
    return len(value.partition(".")[2])


def _makes_sense(value: np.float32) -> bool:
    return bool(value > 0 and np.isfinite(value))


def _moves(text: str) -> bool:
    try:
        return _makes_sense(read(text))
    except ValueError:
        return False


def rounding_slack(text: str) -> float:
    """Return how far from a number that is told with three decimals that may be which was meant.

    With one that isn't 0, or none, it is taken for what somebody has typed; with more it is as good as a float.

    >>> rounding_slack("8.889"), rounding_slack("78.740"), rounding_slack("12.500"), rounding_slack("250")
    (0.0005, 0.0005, 0.0, 0.0)
    """
    decimals = text.partition(".")[2]
    return 0.5 * 10.0**-DECIMALS if len(decimals) == DECIMALS and decimals[1:].strip("0") else 0.0


def is_told_same(told: str | None, meant: str) -> bool:
    """Tell whether a value that is listed may be one that was given; None: it isn't listed."""
    if told is None:
        return False
    try:
        return is_same(read(told), read(meant))
    except ValueError:
        return told == meant


def speed_of(rate: np.float32, steps_per_mm: np.float32) -> Fraction:
    """Return a rate [mm/min] in steps/s, exactly."""
    return exact(rate) * exact(steps_per_mm) / SECONDS_PER_MINUTE


def rate_of(speed_steps_per_s: Fraction, steps_per_mm: np.float32) -> Fraction:
    """Return a speed [steps/s] in mm/min, exactly."""
    return speed_steps_per_s * SECONDS_PER_MINUTE / exact(steps_per_mm)


def kept_acceleration(acceleration: np.float32) -> Fraction:
    """Return what grbl makes of an acceleration [mm/s²]: it keeps it in mm/min²."""
    per_min2 = np.float32(acceleration * np.float32(SECONDS_PER_MINUTE)) * np.float32(SECONDS_PER_MINUTE)
    return exact(per_min2) / SECONDS_PER_MINUTE**2


def acceleration_of(acceleration: np.float32, steps_per_mm: np.float32) -> Fraction:
    """Return what grbl makes of an acceleration [mm/s²], in steps/s², exactly."""
    return kept_acceleration(acceleration) * exact(steps_per_mm)


def _pasted(lines: Iterable[str]) -> Iterator[tuple[int, str]]:
    for line in lines:
        if (found := _PASTED.fullmatch(line.strip())) is not None:
            yield int(found["number"]), found["value"]
