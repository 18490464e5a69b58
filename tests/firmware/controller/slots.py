"""Ramps as they lie in EEPROM."""

import struct

from firmware import protocol as p
from firmware.protocol import Settings


def slot(sequence: int, image: bytes, settings: Settings | None = None) -> bytes:
    content = (settings or Settings()).packed() + image
    header = struct.pack("<BBHIH", 0x53, 2, len(content), sequence, p.crc16(content))
    return (header + struct.pack("<H", p.crc16(header)) + content).ljust(512, b"\xff")
