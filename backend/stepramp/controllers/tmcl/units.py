"""In what units a module has speeds and accelerations, and what its chip makes of them.

A chip of the TMC5160's kind counts speeds in f / 2²⁴ and accelerations in f² / 2⁴¹ of its clock f, in microsteps (its
data sheet, "Real World Unit Conversion"). A module of which microsteps per second are asked works the chip's numbers
out, rounded down, and when it is asked tells what these are in microsteps again.
"""

import math
from dataclasses import dataclass
from enum import IntEnum
from fractions import Fraction

from stepramp.controllers.given_numbers import typed


class UnitMode(IntEnum):
    """What the axis parameter 255 says."""

    CHIP = 0
    STEPS = 1


@dataclass(frozen=True)
class Units:
    """Those of one axis; a step is a microstep of the resolution that the axis is set to."""

    mode: UnitMode
    clock_hz: int

    @property
    def speed_name(self) -> str:
        """What the module's manual calls its unit of speed."""
        return "pps" if self.mode is UnitMode.STEPS else "f/2²⁴"

    @property
    def acceleration_name(self) -> str:
        """What the module's manual calls its unit of acceleration."""
        return "pps²" if self.mode is UnitMode.STEPS else "f²/2⁴¹"

    @property
    def chip_speed(self) -> Fraction:
        """The chip's unit of speed [steps/s]."""
        return Fraction(self.clock_hz, 2**24)

    @property
    def chip_acceleration(self) -> Fraction:
        """The chip's unit of acceleration [steps/s²]."""
        return Fraction(self.clock_hz**2, 2**41)

    @property
    def speed(self) -> Fraction:
        """The module's unit of speed [steps/s]."""
        return Fraction(1) if self.mode is UnitMode.STEPS else self.chip_speed

    @property
    def acceleration(self) -> Fraction:
        """The module's unit of acceleration [steps/s²]."""
        return Fraction(1) if self.mode is UnitMode.STEPS else self.chip_acceleration

    def speed_units(self, steps_per_s: float) -> int:
        """Return a speed [steps/s] in the module's units, towards 0."""
        return int(typed(steps_per_s) / self.speed)

    def acceleration_units(self, steps_per_s2: float) -> int:
        """Return an acceleration [steps/s²] in the module's units, towards 0."""
        return int(typed(steps_per_s2) / self.acceleration)

    def chip_speed_units(self, units: int) -> int:
        """Return what the chip gets of a speed in the module's units."""
        return int(units * self.speed / self.chip_speed)

    def chip_acceleration_units(self, units: int) -> int:
        """Return what the chip gets of an acceleration in the module's units."""
        return int(units * self.acceleration / self.chip_acceleration)

    def acceleration_again(self, told: int) -> int:
        """Return what to send so that the chip has the acceleration again that the module tells, rounded either way."""
        number = round(told * self.acceleration / self.chip_acceleration)
        return math.ceil(number * self.chip_acceleration / self.acceleration)
