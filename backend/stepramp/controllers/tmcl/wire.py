"""How commands to a TMCL module become bytes, and bytes replies: 9 of them either way.

TMCL firmware manuals of Trinamic's modules (TMCM-1240, -1276, -6214 and others), sections 3.1 and 3.2.
"""

import struct
from dataclasses import dataclass
from enum import IntEnum

FRAME_BYTES = 9
MODULE_ADDRESS = 1
"""What a module comes with."""
_LAYOUT = struct.Struct(">BBBBIB")


class Command(IntEnum):
    """What a module is asked or told."""

    ROR = 1
    """Rotate right, at a speed: towards higher positions."""
    ROL = 2
    MST = 3
    """Slow down to rest."""
    MVP = 4
    """Move to a position."""
    SAP = 5
    """Set an axis parameter, until it is reset or switched off."""
    GAP = 6
    """Get an axis parameter."""
    STAP = 7
    """Store an axis parameter as it is."""
    RSAP = 8
    """Set an axis parameter to what is stored."""
    GGP = 10
    """Get a global parameter."""
    STOP_PROGRAM = 128
    """End the program that is stored in the module."""
    VERSION = 136


class Status(IntEnum):
    """What a module says to a command."""

    WRONG_CHECKSUM = 1
    INVALID_COMMAND = 2
    WRONG_TYPE = 3
    INVALID_VALUE = 4
    EEPROM_LOCKED = 5
    NOT_AVAILABLE = 6
    OK = 100


WORDS = {
    Status.WRONG_CHECKSUM: "the command arrived damaged",
    Status.INVALID_COMMAND: "it doesn't know the command",
    Status.WRONG_TYPE: "it has no such parameter",
    Status.INVALID_VALUE: "it doesn't take the value",
    Status.EEPROM_LOCKED: "its memory for settings, the EEPROM, is locked",
    Status.NOT_AVAILABLE: "the command isn't available",
}


@dataclass(frozen=True)
class Reply:
    """What a module answers."""

    address: int
    """Of the module."""
    status: int
    command: int
    """That it answers; 0 for one that arrived damaged."""
    value: int
    """With sign."""

    @property
    def is_told_damage(self) -> bool:
        """Whether the module says that it couldn't read the command."""
        return self.status == Status.WRONG_CHECKSUM and not self.command


def request(command: Command, kind: int = 0, motor: int = 0, value: int = 0) -> bytes:
    """Return a command to the module; value: 32 bits with sign. Raises struct.error for more."""
    head = struct.pack(">BBBBi", MODULE_ADDRESS, command, kind, motor, value)
    return head + bytes([checksum(head)])


def reply_of(frame: bytes) -> Reply | None:
    """Return what nine bytes say; None when their checksum is another one."""
    _, address, status, command, value, told = _LAYOUT.unpack(frame)
    if told != checksum(frame[:-1]):
        return None
    return Reply(address, status, command, value - (value >> 31 << 32))


def checksum(data: bytes) -> int:
    """Return the sum of bytes, without what goes beyond a byte."""
    return sum(data) & 0xFF


def told(status: int) -> str:
    """Return what a status means, as part of a sentence."""
    return WORDS.get(Status(status), "") if status in set(Status) else f"it answers with status {status}"
