"""What a configuration of Klipper says of axes: how far a turn leads, and how fast they may be."""

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Self

from stepramp.controllers.given_numbers import typed
from stepramp.controllers.klipper.configuration import Sections
from stepramp.errors import shown

LETTERS = "xyz"
Z = 2
"""The axis with limits of its own."""
KINEMATICS = ("cartesian", "corexy")
"""Those in which a motor's speed follows from an axis' speed."""
USUAL_FULL_STEPS = 200
USUAL_CRUISE_RATIO = 0.5
PRINTER = "printer"
MOST = 10**9
"""No option of an axis is more, nor one over that."""


class Senseless(ValueError):
    """A configuration that no axis can be told of; its text is the end of a sentence."""


class _Section:
    """A section of a configuration; Senseless for options that make no sense, or are missing and have no usual."""

    def __init__(self, name: str, sections: Sections) -> None:
        self._name = name
        self._options = sections.get(name, {})

    def positive(self, option: str, usual: Fraction | None = None) -> Fraction:
        """Return a number above 0."""
        if usual is not None and option not in self._options:
            return usual
        value = _number(self._text(option))
        if value is None or not 1 / Fraction(MOST) <= value <= MOST:
            raise self._senseless(option, f"a number from {1 / MOST:.9f} to {MOST:,}")
        return value

    def count(self, option: str, usual: int | None = None) -> int:
        """Return a whole number above 0."""
        if usual is not None and option not in self._options:
            return usual
        text = self._text(option)
        try:
            value = int(text)
        except ValueError:
            value = 0
        if not 0 < value <= MOST:
            raise self._senseless(option, f"a whole number from 1 to {MOST:,}")
        return value

    def ratio(self, option: str) -> Fraction:
        """Return what gears after each other make; 1 where there are none."""
        ratio = Fraction(1)
        for each in self._options.get(option, "").split(","):
            numbers = [_number(number) for number in each.split(":")] if each.strip() else [Fraction(1), Fraction(1)]
            match numbers:
                case [Fraction() as driven, Fraction() as driving] if driven > 0 and driving > 0:
                    ratio *= driven / driving
                case _:
                    raise self._senseless(option, "pairs of numbers above 0, such as 57:11, 2:1")
        if not 1 / Fraction(MOST) <= ratio <= MOST:
            raise self._senseless(option, f"gears of 1:{MOST:,} to {MOST:,}:1")
        return ratio

    def _text(self, option: str) -> str:
        if option not in self._options:
            raise Senseless(f"[{self._name}] has no {option}")
        return self._options[option]

    def _senseless(self, option: str, allowed: str) -> Senseless:
        return Senseless(f"{option} of [{self._name}] is {shown(self._options[option])}; allowed: {allowed}")


@dataclass(frozen=True)
class Stepper:
    """The motor of an axis."""

    letter: str
    full_steps: int
    microsteps: int
    travel_per_rev: Fraction
    """How far a turn of it leads, behind its gears [mm]."""

    @classmethod
    def of(cls, sections: Sections, letter: str) -> Self:
        """Return that of an axis; Senseless when it makes no sense."""
        section = _Section(f"stepper_{letter}", sections)
        full_steps = section.count("full_steps_per_rotation", USUAL_FULL_STEPS)
        distance = section.positive("rotation_distance")
        return cls(letter, full_steps, section.count("microsteps"), distance / section.ratio("gear_ratio"))

    @property
    def steps_per_mm(self) -> Fraction:
        """Its steps for each mm of its belt or screw."""
        return self.full_steps * self.microsteps / self.travel_per_rev


@dataclass(frozen=True)
class Limits:
    """How fast axes may be [mm/s, mm/s²]: x and y together, z besides on its own."""

    velocity: Fraction
    accel: Fraction
    z_velocity: Fraction
    z_accel: Fraction

    @classmethod
    def of(cls, sections: Sections) -> Self:
        """Return those of a configuration; Senseless when they make no sense."""
        section = _Section(PRINTER, sections)
        velocity, accel = section.positive("max_velocity"), section.positive("max_accel")
        z_velocity, z_accel = section.positive("max_z_velocity", velocity), section.positive("max_z_accel", accel)
        return cls(velocity, accel, z_velocity, z_accel)

    def velocity_of(self, axis: int) -> Fraction:
        """Return how fast an axis may be [mm/s]."""
        return min(self.velocity, self.z_velocity) if axis == Z else self.velocity

    def accel_of(self, axis: int) -> Fraction:
        """Return how it gains speed, and loses it [mm/s²]."""
        return min(self.accel, self.z_accel) if axis == Z else self.accel


@dataclass(frozen=True)
class Machine:
    """The axes of a printer."""

    kinematics: str
    steppers: tuple[Stepper, ...]
    limits: Limits

    @classmethod
    def of(cls, sections: Sections) -> Self:
        """Return what a configuration tells; Senseless when that makes no sense, or motors are no axes."""
        kinematics = sections.get(PRINTER, {}).get("kinematics", "")
        if kinematics not in KINEMATICS:
            raise Senseless(
                f"its kinematics are {kinematics or 'not told'}: only with cartesian and corexy does a motor's speed "
                "follow from an axis' speed"
            )
        return cls(kinematics, tuple(Stepper.of(sections, letter) for letter in LETTERS), Limits.of(sections))

    @property
    def remark(self) -> str | None:
        """What is to be known of its axes, as a sentence; None for nothing."""
        if self.kinematics != "corexy":
            return None
        return (
            "With corexy no motor is an axis: along x or y alone both motors make this axis' steps, along a diagonal "
            "one of them makes all, 1.41 times as fast as the tool, and the other one rests."
        )


def _number(text: str) -> Fraction | None:
    """Return a number; None for what is none."""
    try:
        value = float(text)
    except ValueError:
        return None
    return typed(value) if math.isfinite(value) else None
