"""What is around a controller that is none of hardware: what can be pressed and moved, and where its axes are."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

LOW_STEPS, HIGH_STEPS = -2000, 20_000
"""Places of the switches, unless they are put elsewhere."""


@dataclass(frozen=True)
class Switches:
    """The switches at the ends of an axis: active from these places on [steps]; None for none."""

    low_steps: int | None = LOW_STEPS
    high_steps: int | None = HIGH_STEPS

    def at(self, end: str | None) -> int | None:
        """Return the place of the switch at an end [steps]."""
        return self.low_steps if end == "low" else self.high_steps

    def is_active(self, end: str | None, place: int) -> bool:
        """Whether the switch at an end is active while the axis is at a place [steps]."""
        at = self.at(end)
        return at is not None and (place <= at if end == "low" else place >= at)


@dataclass(frozen=True)
class AxisSurroundings:
    """An axis in its world: where it is, and its switches [steps]."""

    axis: int
    place_steps: int
    low_steps: int | None
    high_steps: int | None


@dataclass(frozen=True)
class Surroundings:
    """The world at one moment."""

    emergency_stop: bool
    driver_fault: bool
    axes: tuple[AxisSurroundings, ...]


@dataclass(frozen=True)
class SurroundingsChange:
    """What is to be otherwise; None for what stays as it is."""

    emergency_stop: bool | None = None
    driver_fault: bool | None = None
    switches: Mapping[int, Switches] = field(default_factory=dict)
    """Of the axes whose switches are put elsewhere."""


@runtime_checkable
class HasSurroundings(Protocol):
    """What has surroundings that can be changed."""

    @property
    def surroundings(self) -> Surroundings:
        """What is around it now."""

    def change_surroundings(self, change: SurroundingsChange) -> None:
        """Press, release or move something."""
