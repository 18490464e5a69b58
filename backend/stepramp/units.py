"""The one place where units are converted."""

from dataclasses import dataclass
from typing import Literal

MICROSECONDS_PER_SECOND = 1_000_000


def ticks_from_us(microseconds: float, frequency_hz: float) -> float:
    """Return a time [µs] in ticks of a timer [Hz], not rounded."""
    return microseconds * frequency_hz / MICROSECONDS_PER_SECOND


def us_from_ticks(ticks: float, frequency_hz: float) -> float:
    """Return a number of ticks of a timer [Hz] as a time [µs]."""
    return ticks * MICROSECONDS_PER_SECOND / frequency_hz


def speed_from_interval(ticks: float, frequency_hz: float) -> float:
    """Return the speed [steps/s] at which one step takes so many ticks of a timer [Hz]: formula (7), v = F / p."""
    return frequency_hz / ticks


LengthUnit = Literal["steps", "rev", "deg", "mm"]
TimeUnit = Literal["s", "min"]
Quantity = Literal["length", "speed", "acceleration", "jerk"]

DEGREES_PER_REV = 360
SECONDS_PER_TIME_UNIT: dict[TimeUnit, int] = {"s": 1, "min": 60}
LENGTH_WORDS: dict[LengthUnit, str] = {"steps": "steps", "rev": "rev", "deg": "°", "mm": "mm"}
TIME_POWERS: dict[Quantity, int] = {"length": 0, "speed": 1, "acceleration": 2, "jerk": 3}


@dataclass(frozen=True)
class ShownUnits:
    """The units that lengths, speeds, accelerations and jerks of one axis are shown in."""

    length: LengthUnit
    time: TimeUnit
    length_of_step: float
    """[units of length]"""

    def factor(self, quantity: Quantity) -> float:
        """Return what a quantity in steps and seconds is multiplied with."""
        return float(self.length_of_step * SECONDS_PER_TIME_UNIT[self.time] ** TIME_POWERS[quantity])

    def word(self, quantity: Quantity) -> str:
        """Return the unit as people write it.

        >>> ShownUnits("mm", "s", 0.02).word("acceleration")
        'mm/s²'
        """
        power = ("", f"/{self.time}", f"/{self.time}²", f"/{self.time}³")[TIME_POWERS[quantity]]
        return LENGTH_WORDS[self.length] + power
