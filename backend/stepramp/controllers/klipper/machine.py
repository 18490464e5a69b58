"""What a configuration of Klipper says of axes: how far a turn leads, and how fast they may be."""

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Self

from stepramp.controllers.given_numbers import typed
from stepramp.controllers.klipper.configuration import Sections

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
        options = sections.get(f"stepper_{letter}", {})
        try:
            full_steps = int(options.get("full_steps_per_rotation", USUAL_FULL_STEPS))
            microsteps = int(options["microsteps"])
            distance = abs(_number(options["rotation_distance"]))
            gears = [each.split(":") for each in options.get("gear_ratio", "").split(",") if each.strip()]
            ratio = math.prod((_number(driven) / _number(driving) for driven, driving in gears), start=Fraction(1))
        except KeyError as error:
            raise Senseless(f"stepper_{letter} has no {error.args[0]}") from error
        except (ValueError, ZeroDivisionError) as error:
            raise Senseless(f"stepper_{letter} has options that are no numbers") from error
        if not all(0 < each <= MOST for each in (full_steps, microsteps, distance, 1 / distance if distance else 0)):
            raise Senseless(f"stepper_{letter} has options that are not above 0, or beyond any motor")
        if not 1 / Fraction(MOST) <= ratio <= MOST:
            raise Senseless(f"stepper_{letter} has gears that are beyond any")
        return cls(letter, full_steps, microsteps, distance / ratio)

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
        options = sections.get(PRINTER, {})
        try:
            velocity, accel = _double(options["max_velocity"]), _double(options["max_accel"])
            z_velocity = _double(options.get("max_z_velocity", options["max_velocity"]))
            z_accel = _double(options.get("max_z_accel", options["max_accel"]))
        except KeyError as error:
            raise Senseless(f"[printer] has no {error.args[0]}") from error
        except ValueError as error:
            raise Senseless("[printer] has limits that are no numbers") from error
        if not all(1 / Fraction(MOST) <= each <= MOST for each in (velocity, accel, z_velocity, z_accel)):
            raise Senseless("[printer] has limits that are not above 0, or beyond any machine")
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


def _double(text: str) -> Fraction:
    """Return a number as Klipper keeps it."""
    return Fraction(float(_number(text)))


def _number(text: str) -> Fraction:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(text)
    return typed(value)
