"""The EEPROM of the virtual controller: two slots, written a byte at a time, the header last.

So a power cut at any byte leaves the old content or the new one, as docs/serial_protocol.md demands.
"""

import struct
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

from stepramp.controllers.stepramp.frames import crc16
from stepramp.controllers.stepramp.messages.settings import SETTINGS_BYTES
from stepramp.controllers.stepramp.settings import USUAL_OF_INPUTS
from stepramp.controllers.stepramp.soft_limits import NO_LIMITS

SLOT_BYTES = 512
SLOTS = (0, SLOT_BYTES)
MAGIC = 0x53
WITH_INPUTS_BYTES = SETTINGS_BYTES + len(USUAL_OF_INPUTS)
SETTINGS_OF = {2: SETTINGS_BYTES, 3: WITH_INPUTS_BYTES, 4: WITH_INPUTS_BYTES + len(NO_LIMITS)}
"""Length of the settings by the format of a slot [bytes]: without inputs, with them, and with soft limits, too."""
WRITE_TIME_S = 0.0034
"""Time that one changed byte takes [s]: the ATmega328P's."""
ERASED = 0xFF
_HEADER = struct.Struct("<BBHIH")
_CRC_BYTES = 2
HEADER_BYTES = _HEADER.size + _CRC_BYTES
LARGEST_IMAGE_BYTES = 440
"""As the firmware's: a slot would hold 488, but an ATmega328P's stack needs some of the RAM."""


@dataclass(frozen=True)
class Slot:
    """What a slot holds: its sequence number, packed settings and a ramp image."""

    sequence: int = 0
    """0: nothing, or a content whose number was about to be changed when the power was cut."""
    settings: bytes = b""
    image: bytes = b""

    @property
    def age(self) -> tuple[int, bool]:
        """What tells the newer of two slots; the newer one's is higher."""
        return self.sequence, bool(self.image)


class VirtualMemory:
    """Two slots; the good one with the higher sequence number is the active one, the other the previous one."""

    def __init__(self) -> None:
        self.cells = bytearray([ERASED]) * (2 * SLOT_BYTES)
        self._to_write: deque[tuple[int, int]] = deque()
        self._write_began_s = 0.0
        self._written = 0

    @property
    def writing(self) -> bool:
        """Whether bytes are still to be written."""
        return bool(self._to_write)

    def active(self) -> Slot:
        """Return what is stored; an empty slot when nothing is."""
        return max(map(self._slot, SLOTS), key=lambda slot: slot.age)

    def previous(self) -> Slot:
        """Return what was stored before; an empty slot when that is gone."""
        return min(map(self._slot, SLOTS), key=lambda slot: slot.age)

    def begin_write(self, settings: bytes, image: bytes, now_s: float) -> None:
        """Begin to write settings and an image to the slot that isn't active."""
        start, content = self._inactive(), settings + image
        body = enumerate(content, start + HEADER_BYTES)
        self._begin([(start, ERASED), *body, *self._header(start, settings, image)], now_s)

    def begin_restore(self, now_s: float) -> None:
        """Begin to make the previous content, which must be there, the active one: its number and CRC change."""
        previous, start = self.previous(), self._inactive()
        self._begin(self._header(start, previous.settings, previous.image), now_s)

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

    def _begin(self, cells: Iterable[tuple[int, int]], now_s: float) -> None:
        self._write_began_s, self._written = now_s, 0
        self._to_write = deque(cells)

    def _inactive(self) -> int:
        return min(SLOTS, key=lambda start: self._slot(start).age)

    def _header(self, start: int, settings: bytes, image: bytes) -> list[tuple[int, int]]:
        """Return the cells of a header that makes a content the active one, the first byte last."""
        content = settings + image
        slot_format = next(each for each, length in SETTINGS_OF.items() if length == len(settings))
        fields = _HEADER.pack(MAGIC, slot_format, len(content), self.active().sequence + 1, crc16(content))
        header = fields + crc16(fields).to_bytes(_CRC_BYTES, "little")
        return list(reversed(list(enumerate(header, start))))

    def _slot(self, start: int) -> Slot:
        header = bytes(self.cells[start : start + HEADER_BYTES])
        magic, slot_format, length, sequence, crc = _HEADER.unpack_from(header)
        content = bytes(self.cells[start + HEADER_BYTES : start + HEADER_BYTES + length])
        if magic != MAGIC or slot_format not in SETTINGS_OF or len(content) != length or crc16(content) != crc:
            return Slot()
        numbered = crc16(header[:-_CRC_BYTES]) == int.from_bytes(header[-_CRC_BYTES:], "little")
        of_settings = SETTINGS_OF[slot_format]
        return Slot(sequence if numbered else 0, content[:of_settings], content[of_settings:])
