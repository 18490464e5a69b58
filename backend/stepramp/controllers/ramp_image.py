"""Ramp images: a ramp as the bytes that a controller stores; docs/serial_protocol.md has the format.

An image holds segments packed as three variable-length numbers each, as differences from the segment before. Both
lists begin at the slow end.
"""

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from stepramp.ramp.segments import MOST_COUNT, Segment

FORMAT = 1
SAME_DOWN = 0x01
"""Flag: down is the same list as up and is left out."""
MOST_SEGMENTS = 120
MOST_LIST_STEPS = 2**31 - 1
ANY_INTERVAL = range(1, 2**32)
"""What the format can hold of an interval [ticks]; a controller's limits are narrower."""
HEADER = 0xFFFF
"""Index of the fault when it is no segment's."""
_HEADER = struct.Struct("<BBBBI")
_LONGEST_NUMBER = 5
"""Bytes of the longest variable-length number, which holds 35 bits."""


class BadRampImage(ValueError):
    """Bytes that aren't a ramp image; `segment` is the index of the first bad one, those of down after those of up."""

    def __init__(self, segment: int, reason: str) -> None:
        self.segment = segment
        super().__init__(f"{reason} (segment {segment}).")


@dataclass(frozen=True)
class RampImage:
    """A ramp as a controller has it: two lists of segments, each from the slow end, and the interval between."""

    up: tuple[Segment, ...]
    slew_interval_ticks: int
    down: tuple[Segment, ...]

    @property
    def sent_segments(self) -> int:
        """Number of segments that the image holds: those of down only when they differ from those of up."""
        return len(self.up) + (0 if self.down == self.up else len(self.down))

    def encode(self) -> bytes:
        """Return the image as bytes; of any length, since what a controller takes is up to the controller."""
        same = self.down == self.up
        down = () if same else self.down
        header = _HEADER.pack(FORMAT, SAME_DOWN if same else 0, len(self.up), len(down), self.slew_interval_ticks)
        return header + _pack_list(self.up) + _pack_list(down)

    @classmethod
    def decode(cls, image: bytes, limits: range = ANY_INTERVAL) -> "RampImage":
        """Return bytes as an image whose intervals lie within limits [ticks]; BadRampImage when they aren't one."""
        if len(image) < _HEADER.size:
            raise BadRampImage(HEADER, f"{len(image)} bytes are too few for a ramp")
        image_format, flags, up_count, down_count, slew = _HEADER.unpack_from(image)
        if image_format != FORMAT or flags & ~SAME_DOWN:
            raise BadRampImage(HEADER, f"format {image_format} with flags {flags} is not known")
        if (flags and down_count) or up_count + down_count > MOST_SEGMENTS:
            raise BadRampImage(HEADER, f"{up_count} and {down_count} segments, where {MOST_SEGMENTS} are allowed")
        _check_interval(HEADER, slew, limits)
        numbers = _Numbers(image[_HEADER.size :])
        up = tuple(_unpack_list(numbers, up_count, 0, limits))
        down = up if flags else tuple(_unpack_list(numbers, down_count, up_count, limits))
        if numbers.left:
            raise BadRampImage(up_count + down_count, f"{numbers.left} bytes follow the last segment")
        return cls(up, slew, down)

    def keeps(self, limits: range) -> bool:
        """Tell whether all intervals lie within limits [ticks]."""
        try:
            _check_interval(HEADER, self.slew_interval_ticks, limits)
            for index, segment in enumerate((*self.up, *self.down)):
                _check_segment(index, segment, limits)
        except BadRampImage:
            return False
        return True


def _check_segment(index: int, segment: Segment, limits: range) -> None:
    _check_interval(index, segment.interval, limits)
    _check_interval(index, segment.interval + (segment.count - 1) * segment.add, limits)


def _check_interval(index: int, interval: int, limits: range) -> None:
    if interval not in limits:
        allowed = f"{limits.start:,} to {limits.stop - 1:,}"
        raise BadRampImage(index, f"an interval of {interval:,} ticks, where {allowed} is allowed")


def _pack_list(segments: Sequence[Segment]) -> bytes:
    packed = bytearray()
    expected = last_add = 0
    for interval, count, add in segments:
        packed += _pack_number(count)
        packed += _pack_number(_zigzag(interval - expected))
        packed += _pack_number(_zigzag(add - last_add))
        expected, last_add = interval + count * add, add
    return bytes(packed)


def _unpack_list(numbers: "_Numbers", count: int, first_index: int, limits: range) -> Iterator[Segment]:
    expected = last_add = steps = 0
    for index in range(first_index, first_index + count):
        segment_count = numbers.next(index)
        interval = expected + _unzigzag(numbers.next(index))
        last_add += _unzigzag(numbers.next(index))
        if not 1 <= segment_count <= MOST_COUNT:
            raise BadRampImage(index, f"a count of {segment_count}, where 1 to {MOST_COUNT:,} is allowed")
        if not -(2**15) <= last_add < 2**15:
            raise BadRampImage(index, f"an add of {last_add}, where -32,768 to 32,767 is allowed")
        steps += segment_count
        if steps > MOST_LIST_STEPS:
            raise BadRampImage(index, f"{steps:,} steps, where {MOST_LIST_STEPS:,} are allowed")
        segment = Segment(interval, segment_count, last_add)
        _check_segment(index, segment, limits)
        yield segment
        expected = interval + segment_count * last_add


class _Numbers:
    """LEB128: 7 bits a byte, low bits first, the top bit set on all bytes but the last."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._at = 0

    @property
    def left(self) -> int:
        return len(self._data) - self._at

    def next(self, segment: int) -> int:
        value = 0
        for place in range(_LONGEST_NUMBER):
            if not self.left:
                raise BadRampImage(segment, "the image ends within a segment")
            byte = self._data[self._at]
            self._at += 1
            value |= (byte & 0x7F) << 7 * place
            if byte < 0x80:
                return value
        raise BadRampImage(segment, f"a number longer than {_LONGEST_NUMBER} bytes")


def _pack_number(value: int) -> bytes:
    packed = bytearray()
    while value > 0x7F:
        packed.append(value & 0x7F | 0x80)
        value >>= 7
    packed.append(value)
    return bytes(packed)


def _zigzag(value: int) -> int:
    return 2 * value if value >= 0 else -2 * value - 1


def _unzigzag(value: int) -> int:
    return value >> 1 if value % 2 == 0 else -(value >> 1) - 1
