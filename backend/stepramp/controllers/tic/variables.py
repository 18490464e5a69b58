"""What a Tic tells of itself: User's Guide (Pololu 0J71), sections 6 and 7."""

import struct
from dataclasses import dataclass, replace
from enum import IntEnum, IntFlag

from stepramp.controllers.tic.wire import Read


class OperationState(IntEnum):
    """What a Tic does as a whole; only NORMAL obeys targets."""

    RESET = 0
    DEENERGIZED = 2
    SOFT_ERROR = 4
    WAITING_FOR_ERR_LINE = 6
    STARTING_UP = 8
    NORMAL = 10


class Flag(IntFlag):
    """Misc flags 1."""

    ENERGIZED = 1 << 0
    POSITION_UNCERTAIN = 1 << 1
    FORWARD_LIMIT = 1 << 2
    REVERSE_LIMIT = 1 << 3
    HOMING = 1 << 4


class Condition(IntFlag):
    """Error status: what keeps the motor from being moved."""

    DEENERGIZED = 1 << 0
    MOTOR_DRIVER = 1 << 1
    LOW_VIN = 1 << 2
    KILL_SWITCH = 1 << 3
    INPUT_INVALID = 1 << 4
    SERIAL = 1 << 5
    COMMAND_TIMEOUT = 1 << 6
    SAFE_START = 1 << 7
    ERR_LINE = 1 << 8


class PlanningMode(IntEnum):
    """What steps are made for."""

    OFF = 0
    TARGET_POSITION = 1
    TARGET_VELOCITY = 2


class InputState(IntEnum):
    """What kind of thing the Tic was last told to do, obeyed or not."""

    NOT_READY = 0
    INVALID = 1
    HALT = 2
    TARGET_POSITION = 3
    TARGET_VELOCITY = 4


@dataclass(frozen=True)
class Block:
    """A block of a Tic's memory; at most wire.MOST_BLOCK_BYTES long."""

    command: Read
    offset: int
    layout: str
    """As the module struct has it."""

    @property
    def length(self) -> int:
        """Length of the block [bytes]."""
        return struct.calcsize(self.layout)

    def unpack(self, data: bytes) -> tuple[int, ...]:
        """Return the values of a block that was read."""
        return struct.unpack(self.layout, data)


GENERAL = Block(Read.VARIABLES, 0x00, "<BBHIxBi")
"""Operation state, flags, error status, errors occurred, planning mode, target position."""
LAST_OF_ERRORS = replace(GENERAL, command=Read.VARIABLES_FORGETTING_ERRORS)
"""The same, after which no errors have occurred."""
TARGET_VELOCITY = Block(Read.VARIABLES, 0x0E, "<i")
MOTION = Block(Read.VARIABLES, 0x22, "<ii")
"""Position, velocity."""
UP_TIME = Block(Read.VARIABLES, 0x35, "<I")
"""Time since the Tic was switched on or reset [ms]."""
INPUT = Block(Read.VARIABLES, 0x4C, "<B4xi")
"""Input state, input after scaling."""
RAMP = (Block(Read.VARIABLES, 0x12, "<II"), Block(Read.VARIABLES, 0x1A, "<II"))
"""Starting speed, max speed; max deceleration, max acceleration."""
STORED_RAMP = (Block(Read.SETTINGS, 0x43, "<II"), Block(Read.SETTINGS, 0x4B, "<II"))
"""The same as they are after a reset."""
STEP_MODE = Block(Read.VARIABLES, 0x49, "<B")
DRIVER = Block(Read.VARIABLES, 0x49, "<BBB")
"""Step mode, current limit, decay mode."""
MICROSTEPS = {0: 1, 1: 2, 2: 4, 3: 8, 4: 16, 5: 32, 6: 2, 7: 64, 8: 128, 9: 256}
"""How many a step mode makes of a full step; 6 is half steps at full current."""
CONTROL_MODE = Block(Read.SETTINGS, 0x01, "<B")
COMMAND_TIMEOUT = Block(Read.SETTINGS, 0x09, "<H")
"""How long a Tic waits for a command until it stops; 0: for ever [ms]."""
SERIAL_OPTIONS = Block(Read.SETTINGS, 0x0B, "<B")


class SerialOption(IntFlag):
    """What SERIAL_OPTIONS may say of a Tic's serial port; the first firmwares know only the first one."""

    CRC_FOR_COMMANDS = 1 << 0
    CRC_FOR_RESPONSES = 1 << 1


@dataclass(frozen=True)
class General:
    """The Tic as a whole. All but the enumerations in its own units."""

    operation: OperationState
    flags: Flag
    conditions: Condition
    occurred: Condition
    """Also those that are over, since it was told to forget them."""
    planning: PlanningMode
    target_position: int

    @property
    def holds(self) -> bool:
        """Whether the motor has its current, and had it all the time: the driver wasn't just started."""
        return Flag.ENERGIZED in self.flags and self.operation is not OperationState.STARTING_UP

    @property
    def is_homing(self) -> bool:
        """Whether the Tic looks for the place that it counts from, at a limit switch."""
        return Flag.HOMING in self.flags

    @classmethod
    def of(
        cls, operation: int, flags: int, conditions: int, occurred: int, planning: int, target_position: int
    ) -> "General":
        """Return what the block GENERAL says; ValueError when no Tic says so."""
        if flags > sum(Flag) or conditions > sum(Condition):
            raise ValueError("bits that are reserved")
        return cls(
            OperationState(operation),
            Flag(flags),
            Condition(conditions),
            # Its upper half says more of serial errors.
            Condition(occurred & sum(Condition)),
            PlanningMode(planning),
            target_position,
        )


@dataclass(frozen=True)
class Input:
    """What the Tic was last told to do: a position, or a velocity in its units; it keeps that through errors."""

    state: InputState
    value: int

    @classmethod
    def of(cls, state: int, value: int) -> "Input":
        """Return what the block INPUT says; ValueError when no Tic says so."""
        return cls(InputState(state), value)


NEUTRAL = (Input(InputState.TARGET_VELOCITY, 0), Input(InputState.HALT, 0))
"""What leaves a Tic without a target."""


@dataclass(frozen=True)
class Variables:
    """How a Tic fares; velocities in its units, positions in microsteps."""

    general: General
    target_velocity: int
    position: int
    velocity: int

    @property
    def is_under_way(self) -> bool:
        """Whether the motor moves, or is about to: a limit switch may keep it from its target."""
        if self.velocity or self.general.is_homing:
            return True
        is_normal = self.general.operation is OperationState.NORMAL
        return bool(self.ahead) and is_normal and not self.is_held_by_a_switch

    @property
    def is_held_by_a_switch(self) -> bool:
        """Whether the motor rests at a limit switch, with something ahead of it. What homes goes on by itself."""
        if self.general.is_homing:
            return False
        limit = Flag.FORWARD_LIMIT if self.ahead > 0 else Flag.REVERSE_LIMIT
        return bool(self.ahead) and not self.velocity and limit in self.general.flags

    @property
    def ahead(self) -> int:
        """How far the Tic's target is ahead, in steps or as a speed, with its sign; 0: nowhere."""
        return {
            PlanningMode.OFF: 0,
            PlanningMode.TARGET_POSITION: self.general.target_position - self.position,
            PlanningMode.TARGET_VELOCITY: self.target_velocity,
        }[self.general.planning]
