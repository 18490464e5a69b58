"""Frames: COBS(message ‖ CRC-16) and a zero byte, as in docs/serial_protocol.md.

COBS is Cheshire and Baker, "Consistent Overhead Byte Stuffing", 1999.
"""

import binascii
from collections.abc import Mapping

from cobs import cobs  # type: ignore[import-untyped]

LONGEST_FRAME = 60
"""Length of the longest frame, its zero included [bytes]."""
LONGEST_MESSAGE = LONGEST_FRAME - 4
"""What is left for the message: not the CRC's two bytes, COBS's one and the zero [bytes]."""


def crc16(data: bytes) -> int:
    """Return CRC-16/CCITT-FALSE: polynomial 0x1021, start 0xFFFF, not reflected."""
    return binascii.crc_hqx(data, 0xFFFF)


def encode_frame(message: bytes) -> bytes:
    """Return the frame of a message of up to LONGEST_MESSAGE bytes, its zero included.

    Raises ValueError for a longer one.
    """
    if len(message) > LONGEST_MESSAGE:
        raise ValueError(f"A message of {len(message)} bytes; allowed: at most {LONGEST_MESSAGE}.")
    checked = message + crc16(message).to_bytes(2, "little")
    return bytes(cobs.encode(checked)) + b"\0"


def decode_frame(frame: bytes) -> bytes | None:
    """Return the message of a frame, given without its zero; None for what isn't a frame."""
    if not 0 < len(frame) < LONGEST_FRAME:
        return None
    try:
        checked = bytes(cobs.decode(frame))
    except cobs.DecodeError:
        return None
    message, crc = checked[:-2], checked[-2:]
    return message if len(crc) == 2 and crc16(message) == int.from_bytes(crc, "little") else None


class FrameSplitter:
    """Cuts a stream of bytes into messages, and drops what isn't one. instead: messages that other frames stand for."""

    def __init__(self, instead: Mapping[bytes, bytes] | None = None) -> None:
        self._instead = instead or {}
        self._pending = bytearray()

    def feed(self, data: bytes) -> list[bytes]:
        """Take bytes as they come and return the messages they complete."""
        *frames, rest = (bytes(self._pending) + data).split(b"\0")
        # Noise without zeros must not pile up; one byte too many is enough to be known as too long.
        self._pending = bytearray(rest[:LONGEST_FRAME])
        messages = (self._instead.get(frame) or decode_frame(frame) for frame in frames)
        return [message for message in messages if message is not None]
