"""How commands to a Tic become bytes: Tic Stepper Motor Controller User's Guide (Pololu 0J71), sections 8 and 9.

A byte with its top bit set begins a command, all that follow carry 7 bits each. This is the compact protocol, which
any Tic on the line obeys, whatever its device number.
"""

from enum import IntEnum

MOST_BLOCK_BYTES = 14
"""A Tic answers with 15 at a time, and where a CRC follows maybe with one less."""
CRC_POLYNOMIAL = 0x91


class Quick(IntEnum):
    """Commands without data."""

    EXIT_SAFE_START = 0x83
    ENERGIZE = 0x85
    HALT_AND_HOLD = 0x89
    RESET_COMMAND_TIMEOUT = 0x8C


class Write(IntEnum):
    """Commands with 32 bits of data: positions in microsteps, speeds and accelerations in the Tic's own units."""

    TARGET_POSITION = 0xE0
    TARGET_VELOCITY = 0xE3
    STARTING_SPEED = 0xE5
    MAX_SPEED = 0xE6
    MAX_DECELERATION = 0xE9
    MAX_ACCELERATION = 0xEA
    HALT_AND_SET_POSITION = 0xEC


class Read(IntEnum):
    """Commands that are answered with a block of the Tic's memory."""

    VARIABLES = 0xA1
    VARIABLES_FORGETTING_ERRORS = 0xA2
    SETTINGS = 0xA8


def quick(command: Quick) -> bytes:
    """Return a command without data."""
    return bytes([command])


def write(command: Write, value: int) -> bytes:
    """Return a command with a value of 32 bits, with or without sign: the top bits of its bytes travel by themselves.

    Raises OverflowError for a value of more bits.
    """
    data = value.to_bytes(4, "little", signed=value < 0)
    top_bits = sum((byte >> 7) << number for number, byte in enumerate(data))
    return bytes([command, top_bits, *(byte & 0x7F for byte in data)])


def read(command: Read, offset: int, length: int) -> bytes:
    """Return a command that asks for a block of up to MOST_BLOCK_BYTES."""
    return bytes([command, offset, length])


def crc7(data: bytes) -> int:
    """Return the CRC-7 that a Tic may be set to ask for: least bit first, polynomial 0x91, start 0."""
    crc = 0
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc ^ CRC_POLYNOMIAL if crc & 1 else crc) >> 1
    return crc
