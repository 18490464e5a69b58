"""Asking what a controller is doing."""

from dataclasses import dataclass
from enum import IntEnum, IntFlag

from stepramp.controllers.stepramp.messages.body import Reply, Request


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

    def __post_init__(self) -> None:
        MachineState(self.state)
        AxisState(self.axis_state)
