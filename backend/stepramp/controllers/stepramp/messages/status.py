"""Asking what a controller is doing."""

from dataclasses import dataclass
from enum import IntEnum, IntFlag

from stepramp.controllers.stepramp.messages.body import Body, Reply, Request


class MachineState(IntEnum):
    """What a controller is doing."""

    IDLE = 0
    MOVING = 1
    WRITING = 3


class AxisState(IntEnum):
    """What one axis is doing."""

    IDLE = 0
    MOVING = 1
    STOPPING = 2


class StatusFlag(IntFlag):
    """What else a status says."""

    WRITE_FAILED = 1
    ON_TRIAL = 2
    ENABLED = 4


class StopBit(IntFlag):
    """What has stopped motion and has not been acknowledged."""

    EMERGENCY_STOP = 1
    DRIVER_FAULT = 2
    LATENESS = 4


INPUTS_BYTES = 5


@dataclass(frozen=True)
class InputsStatus(Body):
    """What a status says of inputs and homing: all of them masks, of inputs or of axes."""

    LAYOUT = "<HBBB"
    active: int
    stopped_by: int
    """Bits of StopBit."""
    known_axes: int
    """Whose position is known."""
    homing_axes: int


@dataclass(frozen=True)
class StatusRequest(Request):
    """Ask what the controller and one of its axes are doing."""

    KIND = 0x02
    LAYOUT = "<B"
    axis: int


@dataclass(frozen=True)
class StatusReply(Reply):
    """What the controller and one of its axes are doing."""

    LAYOUT = "<BBiiIIIHBB"
    TAIL = range(26)
    state: int
    axis_state: int
    position_steps: int
    target_steps: int
    interval_ticks: int
    steps_made: int
    ramp_sequence: int
    image_crc: int
    flags: int
    starved: int
    more: bytes = b""
    """What inputs, homing and later versions of the protocol add."""

    def __post_init__(self) -> None:
        MachineState(self.state)
        AxisState(self.axis_state)

    @property
    def inputs(self) -> InputsStatus | None:
        """What it says of inputs and homing; None for a controller without inputs."""
        return InputsStatus.unpack(self.more[:INPUTS_BYTES]) if len(self.more) >= INPUTS_BYTES else None
