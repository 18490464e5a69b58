"""What every family of controllers can do, whatever it speaks. What only some can, capabilities.py says."""

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from stepramp.controllers.inputs import InputsState
from stepramp.controllers.remark import OnTrial, told_in
from stepramp.design import Design
from stepramp.errors import Refused, Told
from stepramp.units import us_from_ticks

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
    """Which ramps a controller has."""

    sequence: int | None
    """Sequence number of what was stored; 0: they are only on trial. None for a controller that never stores any."""
    crc: int | None = None
    """CRC-16 of their image; None for a controller that has no image of them."""


@dataclass(frozen=True)
class AxisStatus:
    """What one axis does: position and target [steps], speed without sign [steps/s]."""

    axis: int
    activity: Activity
    position_steps: int
    target_steps: int
    """Where it will come to rest; its position as long as it runs at a speed."""
    speed_steps_per_s: float
    steps_made: int
    """Since it last set out from rest."""
    steps_per_mm: float | None = None
    """What the controller itself is set to; None for one that counts in steps only."""
    microsteps: int | None = None
    """How many of its steps the controller makes of a full step; None where it doesn't tell."""
    position_known: bool | None = None
    """Whether it is known that it is there; None for a controller that doesn't tell."""
    homing: bool | None = None
    """Whether it is being homed; None for a controller that doesn't tell."""
    position_told: bool = True
    """Whether the controller tells where it is; otherwise position and target say nothing."""

    @classmethod
    def untold(cls, activity: Activity = Activity.READY) -> "AxisStatus":
        """Return the first axis of a controller that tells nothing of its axes: a status has one in any case."""
        return cls(0, activity, 0, 0, 0.0, 0, position_told=False)

    @property
    def runs(self) -> bool:
        """Whether it runs at a speed, with no place where it would come to rest."""
        return self.activity is Activity.MOVING and self.target_steps == self.position_steps


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
    starved: int | None = None
    """How often a motor's next step was not known in time since the controller started; None: it doesn't count that."""
    trouble: str | None = None
    """What keeps the motors from being moved, or has cut their last motion short, as a sentence for people."""
    of_inputs: InputsState | None = None
    """What its inputs do; None for a controller without any."""


FigureUnit = Literal["", "steps", "steps/s", "steps/s²", "µs", "Hz", "CRC-16"]
"""Of the figures of a push; "" for a mere number."""


@dataclass(frozen=True)
class OwnTerms:
    """A figure of a push as the controller itself has it, such as $120 [mm/s²]."""

    term: str
    """What the controller calls it."""
    unit: str
    sent: float | None
    """What is sent, or was; None for nothing."""
    on_device: float | None
    """What it has, after a push as it was read back; None for nothing, or nothing that makes sense."""


@dataclass(frozen=True)
class PushItem:
    """One figure of a push on its way [unit]: asked for by the design, sent, and read back from the controller."""

    name: str
    unit: FigureUnit
    requested: float
    sent: float
    read_back: float | None
    """None: what was read back makes no sense."""
    axis: int | None
    """Whose it is; None: all axes'."""
    own: OwnTerms | None = None
    """The same in the controller's own terms; None where those are the same."""


@dataclass(frozen=True)
class PushReport:
    """What came of a push."""

    items: tuple[PushItem, ...]
    verified: bool
    """What was read back is what was sent, as exactly as the controller tells it."""
    segments: int | None
    """None for a controller that takes no segments."""
    bytes: int
    """Length of what the controller was sent [bytes]."""
    largest_deviation_us: float | None
    """Largest difference between an interval of a design's ramp and the controller's [µs].

    None: the controller works out the intervals itself. What is known of that own_ramp.py tells, of the design's move.
    """
    sequence: int | None
    """How often the controller has stored ramps so far; None for one that never does."""
    kept: bool
    """Stored; otherwise on trial."""
    warnings: tuple[str, ...]

    @property
    def warnings_told(self) -> tuple[tuple[Told, ...], ...]:
        """The quantities of each warning that a design's axis converts."""
        return told_in(self.warnings)

    def as_kept(self, sequence: int | None, remarks: Iterable[str]) -> "PushReport":
        """Return the report once what was on trial is stored. remarks: what storing it has told."""
        left = (each for each in self.warnings if not isinstance(each, OnTrial))
        return replace(self, kept=self.verified, sequence=sequence, warnings=(*left, *remarks))


@dataclass(frozen=True)
class PreviewItem:
    """One figure that a push would bring [unit]: as the controller has it now, and as it would be."""

    name: str
    unit: FigureUnit
    on_device: float | None
    """None: the controller has no such figure."""
    to_send: float | None
    """None: it would have none any more."""
    axis: int | None
    """Whose it is; None: all axes'."""
    own: OwnTerms | None = None
    """As in PushItem."""

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
    segments: int | None
    """None for a controller that takes no segments."""
    bytes: int
    """Length of what the controller would be sent [bytes]."""
    largest_deviation_us: float | None
    """As in PushReport."""
    warnings: tuple[str, ...]

    @property
    def warnings_told(self) -> tuple[tuple[Told, ...], ...]:
        """As in PushReport."""
        return told_in(self.warnings)


@dataclass(frozen=True)
class NextTrace:
    """What will be traced next."""

    every_steps: int
    number: int
    """Of the next motion that the axis is told; a controller counts them as long as it is connected."""


@dataclass(frozen=True)
class Trace:
    """The instants of every k-th step of a move. Arrays of shape (n,)."""

    axis: int
    number: int
    """Of the motion; see NextTrace."""
    every_steps: int
    timer_hz: int
    complete: bool
    """The move has ended, and all that there is of it is here."""
    changed: bool
    """The move was changed on its way; what came after that is left out, since no plan is known for it."""
    step: NDArray[np.int64]
    """Which steps, counted from 1. Steps that the port could not carry are left out."""
    planned_ticks: NDArray[np.int64]
    """When they were to be made, from the first step on [ticks]."""
    measured_ticks: NDArray[np.int64]
    """When they were made, from the first step on [ticks]."""

    @property
    def deviation_us(self) -> NDArray[np.float64]:
        """How much later than planned they were made [µs], shape (n,)."""
        late = (self.measured_ticks - self.planned_ticks).astype(np.float64)
        return late * np.float64(us_from_ticks(1, self.timer_hz))


@dataclass(frozen=True)
class AxisCommand:
    """What a request asks of one axis; `field` is what a rejection calls the value."""

    axis: int
    value: float
    field: str


Ends = tuple[int | None, int | None]
"""The lowest and the highest position of an axis [steps]; None: it has none."""


class AnswerUnknown(Refused):
    """An answer was lost, and something more urgent came before the request could be repeated."""


class Controller(Protocol):
    """A controller at an open port: what every family can do. All calls raise DeviceLost when it no longer answers.

    Calls that ask something of axes raise Rejected when a value leads too far or too fast, or there is no such axis,
    and Refused when it can't be done now. Not for two threads at once: the port's worker makes all calls.
    """

    @property
    def lacks(self) -> tuple[type, ...]:
        """The protocols of what others of its family can and this one can't, known once connected."""
        return ()

    @property
    def clocks_hz(self) -> tuple[int, ...]:
        """Clocks that a design's timer may have [Hz], fastest first, known once connected; () for no step timer."""

    @property
    def timer_hz(self) -> int | None:
        """Ticks a second of the clock that the ramps in use are played with [Hz], without any of the slowest one.

        None for a controller without a step timer.
        """

    @property
    def most_axes(self) -> int:
        """How many axes it can have, known once connected."""

    @property
    def firmware_version(self) -> str | None:
        """Version of the firmware, such as 0.2.0, known once connected; None for a controller that doesn't tell."""

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

    def stops_of_others(self) -> int:
        """Return how many stops and halts of somebody else it was heard to obey by now, over this connection."""
        return 0

    def prepare_push(
        self, designs: Sequence[Design], first_axis: int | None = None, mode: PushMode = "keep"
    ) -> Callable[[], PushReport]:
        """Work out what using the designs' ramps takes, and return the call that sends them and reads them back.

        first_axis: of the only design; the other axes keep their ramps. None: the designs are those of all axes.
        mode: keep stores the ramps, for a StoresRamps; try uses them until a roll back or a reset, for a TriesRamps.

        This may take a while and doesn't use the port: for any thread, so that the port's stays free for a stop.
        Raises Rejected when the controller can't play a ramp. The call raises Refused when it can't take them now.
        """

    def preview_push(self, designs: Sequence[Design], first_axis: int | None = None) -> PushPreview:
        """Return what a push of the same would change, without the port: for any thread. Raises as prepare_push."""

    def move_by(self, steps: Sequence[AxisCommand]) -> None:
        """Begin to move axes by so many steps, from where they would come to rest."""

    def move_to(self, positions: Sequence[AxisCommand]) -> None:
        """Begin to move axes to positions [steps]."""

    def run(self, speeds: Sequence[AxisCommand]) -> None:
        """Run axes at speeds, negative for backwards [steps/s]; 0 stops."""

    def keep_within(self, ends: Mapping[int, Ends]) -> None:  # noqa: ARG002  # most are told a speed, and no way
        """Have runs from now on end at these positions by themselves, where a controller is told a way for a run.

        ends: by axis; the others have none. Whoever runs axes ends that in time: this is for when it can't be in time.
        """
        return  # Not abstract: what needs no code is left out.

    def set_position(self, positions: Sequence[AxisCommand]) -> None:
        """Call the places where axes are these positions [steps]."""

    def stop(self, axes: Collection[int] | None = None) -> None:
        """Begin to slow down with the ramp: these axes, or all, also when one of them has no ramp."""

    def halt(self, axes: Collection[int] | None = None) -> None:
        """Make no further step: these axes, or all, also when one of them has no ramp."""

    def steps_to_rest(self, axis: int, speed_steps_per_s: float) -> int:
        """Return how many steps an axis takes to slow down from a speed [steps/s], without the port."""


def lasts_until_end_s(ends: Mapping[int, Ends], places: Mapping[int, float], speeds: Mapping[int, float]) -> float:
    """Return after how long the first of axes that run along a line is at its end [s].

    places: where they set out from [steps]. speeds: negative for backwards [steps/s].
    """
    left = []
    for axis, speed in speeds.items():
        end = ends.get(axis, (None, None))[speed > 0]
        if speed and end is not None:
            left.append(max(0.0, (end - places[axis]) / speed))
    return min(left, default=math.inf)


def values_of(commands: Sequence[AxisCommand]) -> Mapping[int, float]:
    """Return what is asked by axes, in ascending order."""
    return {each.axis: each.value for each in sorted(commands, key=lambda each: each.axis)}
