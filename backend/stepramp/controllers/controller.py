"""What every family of controllers can do, whatever it speaks."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol

from stepramp.design import Design


class Activity(StrEnum):
    """What a connected controller is doing."""

    READY = "ready"
    MOVING = "moving"
    STOPPING = "stopping"
    WRITING = "writing"


@dataclass(frozen=True)
class StoredRamp:
    """Which ramp a controller has: the how-many-th that was stored, and its CRC-16."""

    sequence: int
    crc: int


@dataclass(frozen=True)
class ControllerStatus:
    """What a controller says of itself: position and target [steps], speed without sign [steps/s]."""

    activity: Activity
    position_steps: int
    target_steps: int
    speed_steps_per_s: float
    ramp: StoredRamp | None


@dataclass(frozen=True)
class PushItem:
    """One figure of a push on its way: asked for by the design, sent, and read back from the controller."""

    name: str
    unit: str
    requested: str
    sent: str
    read_back: str


@dataclass(frozen=True)
class PushReport:
    """What came of a push."""

    items: tuple[PushItem, ...]
    verified: bool
    """What was read back is what was sent, byte for byte."""
    segments: int
    bytes: int
    """Length of what the controller stored [bytes]."""
    largest_deviation_us: float
    """Largest difference between an interval of the design's ramp and the controller's [µs]."""
    sequence: int
    warnings: tuple[str, ...]


class Controller(Protocol):
    """A controller at an open port. All calls raise DeviceLost when it no longer answers.

    Not for two threads at once: the port's worker makes all calls.
    """

    @property
    def timer_hz(self) -> int:
        """Ticks a second of the controller's step timer [Hz]; known once connected."""

    @property
    def firmware_version(self) -> str:
        """Version of the firmware, such as 0.1.0; known once connected."""

    def connect(self) -> None:
        """Shake hands with a controller that may just have been reset; Refused when it is of another kind."""

    def status(self) -> ControllerStatus:
        """Ask what the controller is doing."""

    def prepare_push(self, design: Design) -> Callable[[], PushReport]:
        """Work out what storing the design's ramp takes, and return the call that stores it and reads it back.

        This may take a while and doesn't use the port: for any thread, so that the port's stays free for a stop.
        Raises Rejected when the controller can't play the ramp. The call raises Refused when it can't store it now.
        """

    def move_by(self, by_steps: int) -> None:
        """Begin to move by so many steps; Rejected when that leads too far, Refused when it can't move now."""

    def move_to(self, to_steps: int) -> None:
        """Begin to move to a position [steps]; Rejected when that is too far, Refused when it can't move now."""

    def stop(self) -> None:
        """Begin to slow down with the ramp."""

    def halt(self) -> None:
        """Make no further step."""
