"""The EEPROM of the virtual controller: two slots, written a byte at a time, the header last.

So a power cut at any byte leaves the old ramp or the new one, as docs/serial_protocol.md demands.
"""

import struct
from collections import deque

from stepramp.controllers.frames import crc16

SLOT_BYTES = 512
SLOTS = (0, SLOT_BYTES)
MAGIC = 0x53
FORMAT = 1
WRITE_TIME_S = 0.0034
"""Time that one changed byte takes [s]: the ATmega328P's."""
ERASED = 0xFF
_HEADER = struct.Struct("<BBHIH")
_CRC_BYTES = 2
HEADER_BYTES = _HEADER.size + _CRC_BYTES
LARGEST_IMAGE_BYTES = SLOT_BYTES - HEADER_BYTES


class VirtualMemory:
    """Two slots for a ramp image each; the valid one with the higher sequence number is the active one."""

    def __init__(self) -> None:
        self.cells = bytearray([ERASED]) * (2 * SLOT_BYTES)
        self._to_write: deque[tuple[int, int]] = deque()
        self._write_began_s = 0.0
        self._written = 0

    @property
    def writing(self) -> bool:
        """Whether bytes are still to be written."""
        return bool(self._to_write)

    def active(self) -> tuple[int, bytes]:
        """Return the active ramp's sequence number and image; 0 and nothing when there is none."""
        return max((self._slot(start) for start in SLOTS), key=lambda slot: slot[0])

    def begin_write(self, image: bytes, now_s: float) -> None:
        """Begin to write an image to the slot that isn't active."""
        sequence, _ = self.active()
        start = next(start for start in SLOTS if self._slot(start)[0] != sequence or not sequence)
        fields = _HEADER.pack(MAGIC, FORMAT, len(image), sequence + 1, crc16(image))
        header = fields + crc16(fields).to_bytes(_CRC_BYTES, "little")
        self._write_began_s, self._written = now_s, 0
        self._to_write.clear()
        self._to_write.append((start, ERASED))
        self._to_write.extend(enumerate(image, start + HEADER_BYTES))
        self._to_write.extend(reversed(list(enumerate(header, start))))

    def settle(self, now_s: float) -> None:
        """Write the bytes for which there was time until now [s]; bytes that stay the same take none."""
        while self._to_write and now_s >= self._write_began_s + (self._written + 1) * WRITE_TIME_S:
            address, value = self._to_write.popleft()
            if self.cells[address] != value:
                self.cells[address] = value
                self._written += 1

    def cut_power(self) -> None:
        """Forget what is not written yet."""
        self._to_write.clear()

    def _slot(self, start: int) -> tuple[int, bytes]:
        header = bytes(self.cells[start : start + HEADER_BYTES])
        magic, slot_format, length, sequence, crc = _HEADER.unpack_from(header)
        sound = crc16(header[:-_CRC_BYTES]) == int.from_bytes(header[-_CRC_BYTES:], "little")
        image = bytes(self.cells[start + HEADER_BYTES : start + HEADER_BYTES + length])
        if sound and (magic, slot_format) == (MAGIC, FORMAT) and crc16(image) == crc:
            return sequence, image
        return 0, b""
