"""What every family of controllers can do, whatever it speaks."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Literal, Protocol

from stepramp.controllers.stepramp.settings import Settings
from stepramp.controllers.stepramp.trace import Trace
from stepramp.design import Design
from stepramp.errors import Refused

PushMode = Literal["keep", "try"]


class Activity(StrEnum):
    """What a connected controller, or one of its axes, is doing."""

    READY = "ready"
    MOVING = "moving"
    STOPPING = "stopping"
    WRITING = "writing"


UNDER_WAY = (Activity.MOVING, Activity.STOPPING)


@dataclass(frozen=True)
class StoredRamp:
    """Which ramps a controller has: the how-many-th that were stored, and their image's CRC-16."""

    sequence: int
    crc: int


@dataclass(frozen=True)
class AxisStatus:
    """What one axis does: position and target [steps], speed without sign [steps/s]."""

    axis: int
    activity: Activity
    position_steps: int
    target_steps: int
    speed_steps_per_s: float
    steps_made: int
    """Since it last set out from rest."""


@dataclass(frozen=True)
class ControllerStatus:
    """What a controller says of itself."""

    activity: Activity
    axes: tuple[AxisStatus, ...]
    """Each axis that has a ramp; the first one in any case."""
    ramp: StoredRamp | None
    on_trial: bool
    """Ramps or settings are in use that are not stored."""
    motors_on: bool
    starved: int
    """How often a motor's next step was not known in time since the controller started; 0 when all is well."""


@dataclass(frozen=True)
class PushItem:
    """One figure of a push on its way: asked for by the design, sent, and read back from the controller."""

    name: str
    unit: str
    requested: str
    sent: str
    read_back: str
    axis: int | None
    """Whose it is; None: all axes'."""


@dataclass(frozen=True)
class PushReport:
    """What came of a push."""

    items: tuple[PushItem, ...]
    verified: bool
    """What was read back is what was sent, byte for byte."""
    segments: int
    bytes: int
    """Length of what the controller was sent [bytes]."""
    largest_deviation_us: float
    """Largest difference between an interval of a design's ramp and the controller's [µs]."""
    sequence: int
    kept: bool
    """Stored; otherwise on trial."""
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class PreviewItem:
    """One figure that a push would bring: as the controller has it now, and as it would be."""

    name: str
    unit: str
    on_device: str | None
    """None: the controller has no such figure."""
    to_send: str | None
    """None: it would have none any more."""
    axis: int | None
    """Whose it is; None: all axes'."""

    @property
    def differs(self) -> bool:
        """Whether the push would change it."""
        return self.on_device != self.to_send


@dataclass(frozen=True)
class PushPreview:
    """What a push would change, before anything is sent."""

    items: tuple[PreviewItem, ...]
    same: bool
    """The controller has exactly these ramps already."""
    segments: int
    bytes: int
    """Length of what the controller would be sent [bytes]."""
    largest_deviation_us: float
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class Asked:
    """What a request asks of one axis; `field` is what a rejection calls the value."""

    axis: int
    value: float
    field: str


class AnswerUnknown(Refused):
    """An answer was lost, and something more urgent came before the request could be repeated."""


class Controller(Protocol):
    """A controller at an open port. All calls raise DeviceLost when it no longer answers.

    Calls that ask something of axes raise Rejected when a value leads too far or too fast, or there is no such axis,
    and Refused when it can't be done now. Not for two threads at once: the port's worker makes all calls.
    """

    @property
    def clocks_hz(self) -> tuple[int, int]:
        """The step timer's fast and slow clock [Hz]; known once connected."""

    @property
    def timer_hz(self) -> int:
        """Ticks a second of the clock that the ramps in use are played with [Hz]; without any, of the slow one."""

    @property
    def firmware_version(self) -> str:
        """Version of the firmware, such as 0.2.0; known once connected."""

    @property
    def trace(self) -> Callable[[], Trace] | None:
        """What works out the trace of the last move that was traced, in any thread; None before there was one."""

    def connect(self, greeted: Callable[[], None] = lambda: None) -> None:
        """Shake hands with a controller that may just have been reset; Refused when it is of another kind.

        greeted: called as soon as it can be told to stop; what it has is still to be learnt then.
        """

    def disconnect(self) -> None:
        """Say that nobody listens any more."""

    def status(self) -> ControllerStatus:
        """Ask what the controller is doing."""

    def listen(self) -> ControllerStatus | None:
        """Return what the controller has said of itself since the last call, without asking; None for nothing."""

    def prepare_push(
        self, designs: Sequence[Design], first_axis: int | None = None, mode: PushMode = "keep"
    ) -> Callable[[], PushReport]:
        """Work out what using the designs' ramps takes, and return the call that sends them and reads them back.

        first_axis: of the only design; the other axes keep their ramps. None: the designs are those of all axes.
        mode: keep stores the ramps; try uses them until a roll back or a reset.

        This may take a while and doesn't use the port: for any thread, so that the port's stays free for a stop.
        Raises Rejected when the controller can't play a ramp. The call raises Refused when it can't take them now.
        """

    def preview_push(self, designs: Sequence[Design], first_axis: int | None = None) -> PushPreview:
        """Return what a push of the same would change, without the port: for any thread. Raises as prepare_push."""

    def keep(self) -> None:
        """Store the ramps and settings in use."""

    def roll_back(self) -> None:
        """Use the stored ramps and settings again; Refused when nothing else is in use."""

    def restore(self) -> None:
        """Make the ramps and settings that were stored before the stored ones; Refused when there are none."""

    def settings(self) -> Settings:
        """Ask for the settings in use."""

    def use_settings(self, settings: Settings) -> None:
        """Use other settings until a roll back or a reset."""

    def move_by(self, steps: Sequence[Asked]) -> None:
        """Begin to move axes by so many steps, from where they would come to rest."""

    def move_to(self, positions: Sequence[Asked]) -> None:
        """Begin to move axes to positions [steps]."""

    def run(self, speeds: Sequence[Asked]) -> None:
        """Run axes at speeds, negative for backwards [steps/s]; 0 stops."""

    def line(self, steps: Sequence[Asked], ramp_axis: int | None = None) -> None:
        """Begin to move axes along a straight line.

        ramp_axis: whose ramp the axis with most steps plays; None: that of the slowest axis, so that none is faster
        than on its own.
        """

    def set_position(self, positions: Sequence[Asked]) -> None:
        """Call the places where axes are these positions [steps]."""

    def zero(self, axes: Collection[int], steps: int) -> None:
        """Call the places where axes are so many steps and move them to 0, as gauges find their stop."""

    def stop(self, axes: Collection[int] | None = None) -> None:
        """Begin to slow down with the ramp: these axes, or all, also when one of them has no ramp."""

    def halt(self, axes: Collection[int] | None = None) -> None:
        """Make no further step: these axes, or all, also when one of them has no ramp."""

    def steps_to_rest(self, axis: int, speed_steps_per_s: float) -> int:
        """Return how many steps an axis takes to slow down from a speed [steps/s], without the port."""

    def trace_moves(self, axis: int | None, every_steps: int) -> int:
        """Trace every so many-th step of each move of an axis from now on, and return that number; None: no more.

        every_steps: at least; it becomes so many that the port can carry them.
        """


def values_of(asked: Sequence[Asked]) -> Mapping[int, float]:
    """Return what is asked by axes, in ascending order."""
    return {each.axis: each.value for each in sorted(asked, key=lambda each: each.axis)}
