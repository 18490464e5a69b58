"""The settings of a Marlin, as it lists them after M503: the very commands that set them."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from stepramp.controllers.given_numbers import as_float32

LETTERS = "XYZE"
"""Of the axes, in their order."""
EXTRUDER = "E"
STEPS_PER_MM, ACCELERATION, SPEED, ACCELERATIONS, JERK = "M92", "M201", "M203", "M204", "M205"
PRINT, RETRACT, TRAVEL = "P", "R", "T"
"""What M204 holds for: moves with both, moves of the extruder alone, moves without it."""
IN_INCHES = "G20"
DECIMALS = 2
"""Of what it lists."""
HALF_TOLD = Fraction(1, 2 * 10**DECIMALS)
"""By so much a number may differ from what is told of it."""
ULPS = 2
OF_AN_AXIS = (STEPS_PER_MM, SPEED, ACCELERATION)
"""What is needed of each axis."""

_BEFORE = r"\ufeff?\s*(?:[\d:.]+\s+)?(?:[<>]+\s*)?(?:Recv:\s*)?(?:echo:\s*)?"
"""What a file begins with, a host's terminal puts before a line, as a time, and Marlin itself."""
_COMMAND = re.compile(_BEFORE + r"(?P<code>[GM]\d+)(?P<words>(?: +[A-Z](?:-?(?:\d+(?:\.\d*)?|\.\d+))?)*)\s*(?:;.*)?")
_LIKE_AN_AXIS = re.compile(_BEFORE + r"(?P<line>(?:M92|M201|M203) +[A-Z][-+\d.,].*)")
_WORD = re.compile(r"(?P<letter>[A-Z])(?P<value>-?[\d.]+)")


@dataclass(frozen=True)
class AxisSettings:
    """What a Marlin keeps of one axis, as it tells."""

    letter: str
    steps_per_mm: Fraction
    speed: Fraction
    """[mm/s]"""
    acceleration: Fraction
    """[mm/s²]"""
    shared_acceleration: Fraction | None
    """Of M204, that it keeps to, too [mm/s²]; None where it isn't told."""

    @property
    def most_steps_per_mm(self) -> Fraction:
        """The most that they may be, as they are told."""
        return most_of(self.steps_per_mm)

    @property
    def speed_steps_per_s(self) -> float:
        """Its highest speed [steps/s]."""
        return float(self.speed * self.most_steps_per_mm)

    @property
    def effective_acceleration(self) -> Fraction:
        """How it gains speed when it moves on its own [mm/s²]: the extruder's own limit doesn't count then."""
        shared = self.shared_acceleration
        if shared is None or shared <= 0:
            return self.acceleration
        return shared if self.letter == EXTRUDER else min(self.acceleration, shared)

    @property
    def acceleration_steps_per_s2(self) -> float:
        """The same [steps/s²]."""
        return float(self.effective_acceleration * self.steps_per_mm)


@dataclass(frozen=True)
class Settings:
    """All of a listing: commands in their order, each as it is told."""

    commands: Sequence[tuple[str, str]]
    """Code and words, such as M92 and X80.00 Y80.00."""

    @classmethod
    def of(cls, lines: Iterable[str]) -> "Settings":
        """Return the settings that lines tell; other lines are left out."""
        found = (_COMMAND.fullmatch(line.strip()) for line in lines)
        return cls([(each["code"], " ".join(each["words"].split())) for each in found if each is not None])

    def shared_by(self, letter: str) -> str:
        """Return what of M204 an axis keeps to when it moves on its own: in Marlin 1.0 S, and T is for retracts."""
        if self.is_of_marlin_1_0:
            return "T" if letter == EXTRUDER else "S"
        return shared_by(letter)

    def numbers(self) -> Iterator[tuple[str, Sequence[tuple[str, str]]]]:
        """Yield each command's code, and its numbers by letter, also of what is told again."""
        for code, words in self.commands:
            yield code, [(found["letter"], found["value"]) for found in _WORD.finditer(words)]

    def told_by(self, code: str) -> Iterator[dict[str, str]]:
        """Yield the numbers of each command of a code by letter, in their order; those of further extruders not."""
        for each, words in self.commands:
            if each == code:
                told = {found["letter"]: found["value"] for found in _WORD.finditer(words)}
                if code in OF_AN_AXIS and told.get("T", "0") != "0":
                    told.pop(EXTRUDER, None)
                yield told

    def words(self, code: str) -> Mapping[str, str]:
        """Return the numbers of a command by letter; of a letter that is told several times, the last, as it counts."""
        return {letter: value for told in self.told_by(code) for letter, value in told.items()}

    def number(self, code: str, letter: str) -> Fraction | None:
        """Return a number as it is kept; None where it isn't told, or is none."""
        try:
            return as_float32(self.words(code)[letter])
        except (KeyError, ValueError, OverflowError):
            return None

    def decimals_cut(self, code: str, letter: str) -> int | None:
        """Return how many decimals a number should have that ends its line with fewer than all others of it have.

        None for one that has as many, and where the others differ: a person has written them.
        """
        told = [each for each in self.told_by(code) if letter in each]
        if not told or len(told[-1]) == 1 or list(told[-1])[-1] != letter:
            return None
        *others, last = (len(value.partition(".")[2]) for value in told[-1].values())
        return others[0] if len(set(others)) == 1 and last < others[0] else None

    def axis(self, letter: str) -> AxisSettings | None:
        """Return what is kept of an axis; None when it isn't there, or makes no sense."""
        numbers = [self.number(code, letter) for code in OF_AN_AXIS]
        known = [each for each in numbers if each is not None and each > 0]
        if len(known) < len(numbers):
            return None
        scale, speed, acceleration = known
        return AxisSettings(letter, scale, speed, acceleration, self.number(ACCELERATIONS, self.shared_by(letter)))

    def axes(self) -> tuple[AxisSettings, ...]:
        """Return what is kept of the axes, up to the first that isn't told of."""
        found: list[AxisSettings] = []
        for letter in LETTERS:
            if (axis := self.axis(letter)) is None:
                break
            found.append(axis)
        return tuple(found)

    @property
    def scales(self) -> Mapping[str, str]:
        """The steps per mm as they are told, by letter: those of several extruders are told of the one in use only."""
        told = self.words(STEPS_PER_MM)
        sure = "XYZ" if "T" in told else LETTERS
        return {letter: told[letter] for letter in sure if letter in told}

    @property
    def is_of_marlin_1_0(self) -> bool:
        """Whether M204 is that of Marlin 1.0: S for all moves, and T for retracts."""
        told = self.words(ACCELERATIONS)
        return "S" in told and PRINT not in told

    @property
    def is_in_inches(self) -> bool:
        """Whether lengths are told, and taken, in inches."""
        return any(code == IN_INCHES for code, _ in self.commands)


def unreadable(lines: Iterable[str]) -> list[str]:
    """Return the lines that are to set an axis, but not with numbers as Marlin takes them."""
    found = (_LIKE_AN_AXIS.fullmatch(line.strip()) for line in lines if _COMMAND.fullmatch(line.strip()) is None)
    return [each["line"] for each in found if each is not None]


def shared_by(letter: str) -> str:
    """Return what of M204 an axis keeps to when it moves on its own."""
    return RETRACT if letter == EXTRUDER else TRAVEL


def is_rounded(scale: Fraction) -> bool:
    """Tell whether steps per mm may be others than they are told as: a whole number of them is what somebody has set.

    What has more decimals than are told is none that was told.
    """
    text = f"{float(scale):.{DECIMALS}f}"
    is_told = float(scale) in (float(text), float(as_float32(text)))
    return is_told and Fraction(text).denominator != 1


def most_of(scale: Fraction) -> Fraction:
    """Return the most that steps per mm may be that are told as so many."""
    return scale + HALF_TOLD if is_rounded(scale) else scale


def is_same(told: Fraction | None, meant: Fraction) -> bool:
    """Tell whether a number that is listed may be one that was given."""
    if told is None:
        return False
    slack = float(HALF_TOLD) + ULPS * float(np.spacing(np.float32(max(abs(told), abs(meant)))))
    return abs(float(told - meant)) <= slack
