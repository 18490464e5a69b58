"""Ramp images: the ramps of a controller's axes as the bytes that it stores; docs/serial_protocol.md has the format.

A ramp is two lists of segments, both from the slow end, or the constants of a formula that the controller computes. A
segment is packed as three variable-length numbers, as differences from the segment before. Axes may share a ramp.
"""

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from stepramp.controllers.stepramp.formula_constants import decode_formula
from stepramp.controllers.stepramp.messages.axes import MOST_AXES
from stepramp.controllers.stepramp.messages.session import HelloReply
from stepramp.ramp.segments import MOST_COUNT, Segment

FORMAT = 2
FAST_CLOCK = 0x01
"""Flag: intervals are ticks of the fast clock."""
SAME_DOWN = 0x01
"""Flag of a ramp: down is the same list as up and is left out."""
OF_SEGMENTS, BY_FORMULA = 0, 1
SLOW_CLOCK_HZ, FAST_CLOCK_HZ = 2_000_000, 16_000_000
"""Those of the project's own firmware; another controller tells its own in its hello [Hz]."""
MOST_SEGMENTS = 250
LONGEST_INTERVAL_TICKS = 2**28 - 1
HEADER = 0xFF
"""Instead of a ramp's or a segment's number: the fault lies in the header."""
_IMAGE_HEADER = struct.Struct("<BBBB")
_RAMP_HEADER = struct.Struct("<BH")
_LISTS_HEADER = struct.Struct("<BBBIH")
_NUMBER_BITS = 31


class BadRampImage(ValueError):
    """Bytes that aren't a ramp image: which ramp is the first bad one, and which of its segments, down after up."""

    def __init__(self, ramp: int, segment: int, reason: str) -> None:
        self.ramp, self.segment = ramp, segment
        super().__init__(f"{reason} (ramp {ramp}, segment {segment}).")

    @property
    def detail(self) -> int:
        """What a controller tells of it."""
        return self.ramp << 8 | self.segment


@dataclass(frozen=True)
class IntervalLimits:
    """Which intervals a controller plays."""

    shortest: int
    """Of a ramp of segments [fast ticks]."""
    shortest_formula: int
    """Of a ramp by formula [fast ticks]."""
    longest_ticks: int
    fast_ticks_a_slow_tick: int

    @classmethod
    def of(cls, hello: HelloReply) -> "IntervalLimits":
        """Return the limits of a controller, from its hello."""
        ratio = hello.fast_clock_hz // hello.slow_clock_hz
        shortest, formula = hello.shortest_intervals[0], hello.shortest_formula_interval
        return cls(shortest, formula, hello.longest_interval_ticks, ratio)

    def of_segments(self, *, fast_clock: bool) -> range:
        """Return the intervals allowed in a ramp of segments [ticks]."""
        return self._from(self.shortest, fast_clock)

    def by_formula(self, *, fast_clock: bool) -> range:
        """Return the intervals allowed in a ramp by formula [ticks]."""
        return self._from(self.shortest_formula, fast_clock)

    def _from(self, shortest: int, fast_clock: bool) -> range:
        ticks = shortest if fast_clock else -(-shortest // self.fast_ticks_a_slow_tick)
        return range(ticks, self.longest_ticks + 1)


ANY_INTERVAL = IntervalLimits(1, 1, LONGEST_INTERVAL_TICKS, 1)
"""What the format can hold; a controller's limits are narrower."""


@dataclass(frozen=True)
class SegmentRamp:
    """Two lists of segments, each from the slow end, and the interval between."""

    up: tuple[Segment, ...]
    slew_interval_ticks: int
    down: tuple[Segment, ...]

    @property
    def sent_segments(self) -> int:
        """Number of segments that the image holds: those of down only when they differ from those of up."""
        return len(self.up) + (0 if self.down == self.up else len(self.down))

    def encode(self) -> bytes:
        """Return the ramp as bytes, its header included."""
        same = self.down == self.up
        up, down = _pack_list(self.up), b"" if same else _pack_list(self.down)
        counts = SAME_DOWN if same else 0, len(self.up), 0 if same else len(self.down)
        body = _LISTS_HEADER.pack(*counts, self.slew_interval_ticks, len(up)) + up + down
        return _RAMP_HEADER.pack(OF_SEGMENTS, len(body)) + body

    def keeps(self, limits: range) -> bool:
        """Tell whether all intervals lie within limits [ticks]."""
        ends = [end for segment in (*self.up, *self.down) for end in (segment.interval, _last(segment))]
        return all(interval in limits for interval in (self.slew_interval_ticks, *ends))


@dataclass(frozen=True)
class FormulaRamp:
    """The constants of a ramp that the controller computes while it plays it, packed."""

    constants: bytes

    @property
    def sent_segments(self) -> int:
        """None: it needs no segments."""
        return 0

    def encode(self) -> bytes:
        """Return the ramp as bytes, its header included."""
        return _RAMP_HEADER.pack(BY_FORMULA, len(self.constants)) + self.constants


AxisRamp = SegmentRamp | FormulaRamp


@dataclass(frozen=True)
class RampImage:
    """The ramps of all axes, and the clock that they are played with."""

    fast_clock: bool
    axes: tuple[AxisRamp, ...]
    """The ramp of each axis. Equal ones are stored once."""

    @property
    def ramps(self) -> tuple[AxisRamp, ...]:
        """The ramps that the image holds, in the order of the axes that first use them."""
        return tuple(dict.fromkeys(self.axes))

    @property
    def sent_segments(self) -> int:
        """Number of segments that the image holds."""
        return sum(ramp.sent_segments for ramp in self.ramps)

    def encode(self) -> bytes:
        """Return the image as bytes; of any length, since what a controller takes is up to the controller."""
        ramps = self.ramps
        header = _IMAGE_HEADER.pack(FORMAT, FAST_CLOCK if self.fast_clock else 0, len(self.axes), len(ramps))
        assigned = bytes(ramps.index(ramp) for ramp in self.axes)
        return header + assigned + b"".join(ramp.encode() for ramp in ramps)

    @classmethod
    def decode(cls, image: bytes, limits: IntervalLimits = ANY_INTERVAL) -> "RampImage":
        """Return bytes as an image whose intervals lie within limits; BadRampImage when they aren't one."""
        flags, numbers, ramps_count = _decode_header(image)
        fast_clock, at = bool(flags & FAST_CLOCK), _IMAGE_HEADER.size + len(numbers)
        ramps: list[AxisRamp] = []
        for number in range(ramps_count):
            if len(image) - at < _RAMP_HEADER.size:
                raise BadRampImage(number, HEADER, "the image ends before this ramp")
            kind, length = _RAMP_HEADER.unpack_from(image, at)
            at += _RAMP_HEADER.size
            if length > len(image) - at:
                raise BadRampImage(number, HEADER, "the image ends within this ramp")
            body = image[at : at + length]
            at += length
            if kind == OF_SEGMENTS:
                ramps.append(_decode_lists(number, body, limits.of_segments(fast_clock=fast_clock)))
            elif kind == BY_FORMULA:
                ramps.append(_decode_formula(number, body, limits.by_formula(fast_clock=fast_clock)))
            else:
                raise BadRampImage(number, HEADER, f"kind {kind} is not known")
        if at != len(image):
            raise BadRampImage(HEADER, HEADER, f"{len(image) - at} bytes follow the last ramp")
        return cls(fast_clock, tuple(ramps[each] for each in numbers))


def _decode_header(image: bytes) -> tuple[int, bytes, int]:
    """Return the flags, the number of each axis' ramp, and how many ramps there are."""
    if len(image) < _IMAGE_HEADER.size:
        raise BadRampImage(HEADER, HEADER, f"{len(image)} bytes are too few for a ramp image")
    image_format, flags, axes, ramps = _IMAGE_HEADER.unpack_from(image)
    numbers = image[_IMAGE_HEADER.size : _IMAGE_HEADER.size + axes]
    if image_format != FORMAT or flags & ~FAST_CLOCK:
        raise BadRampImage(HEADER, HEADER, f"format {image_format} with flags {flags} is not known")
    if not 1 <= ramps <= axes <= MOST_AXES or len(numbers) != axes or set(numbers) != set(range(ramps)):
        raise BadRampImage(HEADER, HEADER, f"{ramps} ramps for {axes} axes, where each ramp must be some axis'")
    return flags, numbers, ramps


def _decode_formula(number: int, constants: bytes, limits: range) -> FormulaRamp:
    try:
        decode_formula(constants, limits)
    except ValueError as error:
        raise BadRampImage(number, HEADER, str(error)) from error
    return FormulaRamp(constants)


def _decode_lists(number: int, body: bytes, limits: range) -> SegmentRamp:
    if len(body) < _LISTS_HEADER.size:
        raise BadRampImage(number, HEADER, f"{len(body)} bytes are too few for two lists")
    flags, up_count, down_count, slew, up_bytes = _LISTS_HEADER.unpack_from(body)
    lists = body[_LISTS_HEADER.size :]
    if flags & ~SAME_DOWN or (flags and down_count) or up_bytes > len(lists):
        raise BadRampImage(number, HEADER, f"flags {flags} with {down_count} down segments make no sense")
    if up_count + down_count > MOST_SEGMENTS:
        raise BadRampImage(number, HEADER, f"{up_count + down_count} segments, where {MOST_SEGMENTS} are allowed")
    if slew not in limits:
        raise BadRampImage(number, HEADER, _allowed(slew, limits))
    up = tuple(_unpack_list(_Numbers(lists[:up_bytes], number), up_count, 0, limits))
    down = tuple(_unpack_list(_Numbers(lists[up_bytes:], number), down_count, up_count, limits))
    return SegmentRamp(up, slew, up if flags else down)


def _last(segment: Segment) -> int:
    return segment.interval + (segment.count - 1) * segment.add


def _allowed(interval: int, limits: range) -> str:
    return f"an interval of {interval:,} ticks, where {limits.start:,} to {limits.stop - 1:,} is allowed"


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
    expected = last_add = 0
    for index in range(first_index, first_index + count):
        segment_count = numbers.next(index)
        interval = expected + _unzigzag(numbers.next(index))
        last_add += _unzigzag(numbers.next(index))
        if not 1 <= segment_count <= MOST_COUNT:
            raise numbers.bad(index, f"a count of {segment_count}, where 1 to {MOST_COUNT:,} is allowed")
        if not -(2**15) <= last_add < 2**15:
            raise numbers.bad(index, f"an add of {last_add}, where -32,768 to 32,767 is allowed")
        segment = Segment(interval, segment_count, last_add)
        for end in (interval, _last(segment)):
            if end not in limits:
                raise numbers.bad(index, _allowed(end, limits))
        yield segment
        expected = interval + segment_count * last_add
    if numbers.left:
        raise numbers.bad(first_index + count, f"{numbers.left} bytes follow the last segment")


class _Numbers:
    """LEB128: 7 bits a byte, low bits first, the top bit set on all bytes but the last."""

    def __init__(self, data: bytes, ramp: int) -> None:
        self._data = data
        self._ramp = ramp
        self._at = 0

    @property
    def left(self) -> int:
        return len(self._data) - self._at

    def bad(self, segment: int, reason: str) -> BadRampImage:
        return BadRampImage(self._ramp, segment, reason)

    def next(self, segment: int) -> int:
        value = 0
        for shift in range(0, _NUMBER_BITS, 7):
            if not self.left:
                raise self.bad(segment, "the list ends within a segment")
            byte = self._data[self._at]
            self._at += 1
            value |= (byte & 0x7F) << shift
            if byte < 0x80 and not value >> _NUMBER_BITS:
                return value
        raise self.bad(segment, f"a number of more than {_NUMBER_BITS} bits")


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
