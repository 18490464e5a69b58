"""What is known of one side of a ramp, whatever its shape: speed and time over position."""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from stepramp.numerics.drive_train import DriveTrain
from stepramp.numerics.numbers import Number


@dataclass(frozen=True)
class ShapeParameters:
    """What some shapes have beside speeds and acceleration; each takes its own."""

    jerk: float = math.inf
    """j: the fastest that the acceleration changes [steps/s³]."""
    points: tuple[tuple[float, float], ...] = ()
    """Speeds, increasing [steps/s], and which part of the acceleration holds there."""
    drive_train: DriveTrain | None = None
    """The motor with its drive and its load."""
    margin: float = 1.0
    """m: how much of the motor's torque is used."""


NO_PARAMETERS = ShapeParameters()


@dataclass(frozen=True)
class Slope(ABC):
    """One side of a ramp: from the base speed to the slew speed, or back."""

    rank: ClassVar[int] = 100
    """Where the shape stands in lists: shapes with less stand before it."""
    label: ClassVar[str] = ""
    """What people call it; empty: its name."""
    summary: ClassVar[str] = ""
    """What grows how, in a few words."""
    help: ClassVar[str] = ""
    """What it is good for, in a sentence or two."""
    takes: ClassVar[frozenset[str]] = frozenset()
    """Names of the parameters that the shape needs."""
    begins_alike: ClassVar[bool] = True
    """Whether a ramp to a lower speed is the beginning of the one to a higher speed, step by step."""

    timer_hz: float
    """F [Hz]."""
    base_speed: float
    """v0 [steps/s]."""
    slew_speed: float
    """v [steps/s]."""
    acceleration: float
    """a, or d on the ramp down: the largest along the slope, without sign [steps/s²]."""
    parameters: ShapeParameters = NO_PARAMETERS

    @property
    @abstractmethod
    def length(self) -> float:
        """S: from the base to the slew speed [steps, not whole]."""

    @abstractmethod
    def acceleration_over(self, steps: float) -> float:
        """Return the acceleration with which the slope would be so long [steps/s²]; inf where none makes it so."""

    @abstractmethod
    def speeds(self, first: float, count: int, number: Number) -> NDArray[np.floating]:
        """Return the speeds at `first`, `first` + 1 … steps from the base speed [steps/s], shape (count,).

        Computed in numbers of the given type.
        """

    @abstractmethod
    def durations(self, number: Number) -> NDArray[np.floating]:
        """Return the time that each whole step takes, slowest first [ticks], shape (steps,); in such numbers."""

    def intervals(self, first: float, count: int, number: Number) -> NDArray[np.floating]:
        """Return F / v at the speeds v of `speeds` [ticks], shape (count,); a shape that has them sooner says so."""
        speeds = self.speeds(first, count, number)
        np.divide(number(self.timer_hz), speeds, out=speeds)
        return speeds

    def lowered(self, peak_speed: float) -> Self:
        """Return the slope to a lower speed than its own [steps/s], nowhere steeper or with more jerk."""
        return replace(self, slew_speed=peak_speed)

    @property
    def steps(self) -> int:
        """Whole steps of the slope: the next one runs at slew speed [steps]."""
        return math.floor(self.length)

    @property
    def slew_interval(self) -> float:
        """PS = F / v, formula (18) [ticks]."""
        return self.timer_hz / self.slew_speed
