"""The one place where units are converted."""

import math
from dataclasses import dataclass
from typing import Literal

MICROSECONDS_PER_SECOND = 1_000_000
SECONDS_PER_MINUTE = 60


def ticks_from_us(microseconds: float, frequency_hz: float) -> float:
    """Return a time [µs] in ticks of a timer [Hz], not rounded."""
    return microseconds * frequency_hz / MICROSECONDS_PER_SECOND


def us_from_ticks(ticks: float, frequency_hz: float) -> float:
    """Return a number of ticks of a timer [Hz] as a time [µs]."""
    return ticks * MICROSECONDS_PER_SECOND / frequency_hz


def speed_from_interval(ticks: float, frequency_hz: float) -> float:
    """Return the speed [steps/s] at which one step takes so many ticks of a timer [Hz]: formula (7), v = F / p."""
    return frequency_hz / ticks


def interval_from_speed(speed_steps_per_s: float, frequency_hz: float) -> int:
    """Return the interval of a speed [steps/s] in whole ticks of a timer [Hz], the nearest, halves up: p = F / v (7).

    >>> interval_from_speed(16_000, 1_000_000)  # 62.5 ticks
    63
    """
    return math.floor(frequency_hz / speed_steps_per_s + 0.5)


def kg_m2_from_g_cm2(inertia_g_cm2: float) -> float:
    """Return a moment of inertia [g·cm²] in kg·m²."""
    return inertia_g_cm2 * 1e-7


def g_cm2_from_kg_m2(inertia_kg_m2: float) -> float:
    """Return a moment of inertia [kg·m²] in g·cm²."""
    return inertia_kg_m2 * 1e7


def rad_per_s_from_rpm(rpm: float) -> float:
    """Return a speed [rpm] in rad/s."""
    return rpm * 2 * math.pi / SECONDS_PER_MINUTE


def rpm_from_rad_per_s(speed_rad_per_s: float) -> float:
    """Return a speed [rad/s] in rpm."""
    return speed_rad_per_s * SECONDS_PER_MINUTE / (2 * math.pi)


def rpm_from_deg_per_s(speed_deg_per_s: float) -> float:
    """Return a speed [°/s] in rpm."""
    return speed_deg_per_s * SECONDS_PER_MINUTE / DEGREES_PER_REV


def rad_from_deg(angle_deg: float) -> float:
    """Return an angle [°] in rad."""
    return math.radians(angle_deg)


def m_from_mm(length_mm: float) -> float:
    """Return a length [mm] in m."""
    return length_mm / 1000


def henry_from_mh(inductance_mh: float) -> float:
    """Return an inductance [mH] in H."""
    return inductance_mh / 1000


def peak_from_rms(current_rms_a: float) -> float:
    """Return the peak of a sine's current by its RMS value [A]."""
    return current_rms_a * math.sqrt(2)


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
