"""Messages: requests, replies and notices as objects, and as bytes. What they mean is in docs/serial_protocol.md.

Each body is a dataclass whose fields stand in the order of its layout; a body of no fixed length ends in a field that
holds as many items as there are. Nothing here reads or writes a port.
"""

import struct
from collections.abc import Iterable
from dataclasses import dataclass, fields
from enum import IntEnum, IntFlag
from typing import ClassVar, Self, TypeVar

PROTOCOL_VERSION = 2
REPLY = 0x80
MOST_DATA = 48
"""Most bytes of a ramp image in one message."""
MOST_AXES = 4
MOST_TRACE_VALUES = 12
SETTINGS_BYTES = 12
ALL_AXES = (1 << MOST_AXES) - 1
TRACE_OFF = 255
TRACE_LAST = 0x80
"""Added to the axis in the last trace frame of a move."""
MOST_REPORTS_HZ = 50
_HEADER = struct.Struct("<BHB")


class ReplyStatus(IntEnum):
    """How a request went: the first byte of each reply."""

    OK = 0
    UNKNOWN_KIND = 1
    BAD_LENGTH = 2
    STALE_SESSION = 3
    MOVING = 4
    NO_RAMP = 5
    OUT_OF_RANGE = 6
    OUT_OF_ORDER = 7
    BAD_CRC = 8
    BAD_RAMP = 9
    WRITING = 10
    BAD_VERSION = 11
    TOO_FAST = 12


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


class RampInUse(IntEnum):
    """Where the ramps come from that moves are played with."""

    NONE = 0
    STORED = 1
    ON_TRIAL = 2


class StatusFlag(IntFlag):
    """What else a status says."""

    WRITE_FAILED = 1
    ON_TRIAL = 2
    ENABLED = 4


class ReadSource(IntEnum):
    """What a read reads."""

    STORED = 0
    RAM = 1
    PREVIOUS = 2


@dataclass(frozen=True)
class Message:
    """A request, reply or notice with its header; the body still bytes."""

    kind: int
    session: int
    tag: int
    body: bytes = b""

    def pack(self) -> bytes:
        """Return the message as bytes."""
        return _HEADER.pack(self.kind, self.session, self.tag) + self.body

    @classmethod
    def unpack(cls, message: bytes) -> Self | None:
        """Return bytes as a message; None when they are too few for a header."""
        if len(message) < _HEADER.size:
            return None
        kind, session, tag = _HEADER.unpack_from(message)
        return cls(kind, session, tag, message[_HEADER.size :])


@dataclass(frozen=True)
class Body:
    """What follows the header."""

    LAYOUT: ClassVar[str] = "<"
    """Of all fields, as `struct` has it; without the last one when that has no fixed length."""
    TUPLES: ClassVar[dict[str, int]] = {}
    """Fields that hold several values of the layout, and how many."""
    TAIL: ClassVar[range] = range(1)
    """How many items the last field may hold when it has no fixed length."""
    EACH: ClassVar[str] = "B"
    """Layout of one of these items; bytes are a field of type bytes."""

    def pack(self) -> bytes:
        """Return the body as bytes."""
        values = [getattr(self, field.name) for field in fields(self)]
        tail = values.pop() if len(self.TAIL) > 1 else ()
        flat = [each for value in values for each in (value if isinstance(value, tuple) else (value,))]
        items = (item if isinstance(item, tuple) else (item,) for item in tail)
        return struct.pack(self.LAYOUT, *flat) + b"".join(struct.pack("<" + self.EACH, *item) for item in items)

    @classmethod
    def unpack(cls, data: bytes) -> Self:
        """Return bytes as a body; ValueError when their number is wrong."""
        size = struct.calcsize(cls.LAYOUT)
        count, left = divmod(len(data) - size, struct.calcsize("<" + cls.EACH))
        if left or count not in cls.TAIL:
            raise ValueError(f"{cls.__name__} of {len(data)} bytes; allowed: from {size + cls.TAIL[0]}.")
        flat = list(struct.unpack_from(cls.LAYOUT, data))
        named: dict[str, object] = {}
        for field in fields(cls)[: -1 if len(cls.TAIL) > 1 else None]:
            many = cls.TUPLES.get(field.name)
            named[field.name] = flat.pop(0) if many is None else tuple(flat.pop(0) for _ in range(many))
        if len(cls.TAIL) > 1:
            named[fields(cls)[-1].name] = cls._items(data[size:])
        return cls(**named)

    @classmethod
    def _items(cls, tail: bytes) -> object:
        if cls.EACH == "B":
            return tail
        items = struct.iter_unpack("<" + cls.EACH, tail)
        return tuple(item if len(item) > 1 else item[0] for item in items)


class Request(Body):
    """The body of a request."""

    KIND: ClassVar[int]
    HARMLESS_TWICE: ClassVar[bool] = True
    """Whether it may be carried out a second time without harm, or can't be."""


class Reply(Body):
    """The body of a reply, after its status."""


class Notice(Body):
    """The body of a frame that nobody asked for."""

    KIND: ClassVar[int]


def mask_of(axes: Iterable[int]) -> int:
    """Return axes as bits, axis 0 the lowest."""
    return sum(1 << axis for axis in set(axes))


def axes_of(mask: int) -> list[int]:
    """Return the axes whose bits are set, in ascending order."""
    return [axis for axis in range(mask.bit_length()) if mask >> axis & 1]


@dataclass(frozen=True)
class AxesRequest(Request):
    """A request with one value for each axis of a mask, in ascending order."""

    LAYOUT = "<B"
    TAIL = range(9)
    EACH = "i"
    axes: int
    values: tuple[int, ...]

    def __post_init__(self) -> None:
        if self.axes.bit_count() != len(self.values):
            raise ValueError(f"{len(self.values)} values for {self.axes.bit_count()} axes.")

    @property
    def by_axis(self) -> dict[int, int]:
        """The values by their axes."""
        return dict(zip(axes_of(self.axes), self.values, strict=True))


@dataclass(frozen=True)
class DoneReply(Reply):
    """Done, or begun: the reply to requests that ask for nothing back."""


@dataclass(frozen=True)
class TargetsReply(Reply):
    """Where each axis that was asked will come to rest [steps]."""

    TAIL = range(MOST_AXES + 1)
    EACH = "i"
    targets_steps: tuple[int, ...]


@dataclass(frozen=True)
class HelloRequest(Request):
    """Begin a session."""

    KIND = 0x01
    LAYOUT = "<B"
    protocol_version: int = PROTOCOL_VERSION


@dataclass(frozen=True)
class HelloReply(Reply):
    """What the controller is, what it can do, and which ramp it has."""

    LAYOUT = "<4B 2I 4H 3H I HH 3B I H B"
    TUPLES: ClassVar[dict[str, int]] = {"shortest_intervals": MOST_AXES, "shortest_line_intervals": MOST_AXES - 1}
    protocol_version: int
    firmware_major: int
    firmware_minor: int
    firmware_patch: int
    fast_clock_hz: int
    slow_clock_hz: int
    shortest_intervals: tuple[int, ...]
    """When 1, 2, 3, 4 axes move at the same time [fast ticks]."""
    shortest_line_intervals: tuple[int, ...]
    """Of the leader of a line of 2, 3, 4 axes [fast ticks]."""
    longest_interval_ticks: int
    shortest_formula_interval: int
    """Of a ramp that is computed while it is played [fast ticks]."""
    largest_image_bytes: int
    most_segments: int
    """Of one ramp, up and down together."""
    axes: int
    reset_cause: int
    """Bits: power, external, brown-out, watchdog."""
    ramp_sequence: int
    image_crc: int
    ramp_in_use: int

    def __post_init__(self) -> None:
        if not self.fast_clock_hz or not self.slow_clock_hz or self.fast_clock_hz % self.slow_clock_hz:
            raise ValueError(f"Clocks of {self.fast_clock_hz} Hz and {self.slow_clock_hz} Hz.")
        if not 1 <= self.axes <= MOST_AXES:
            raise ValueError(f"{self.axes} axes.")
        intervals = self.longest_interval_ticks, self.shortest_formula_interval, *self.shortest_intervals[: self.axes]
        if not all(intervals):
            raise ValueError(f"Intervals of 0 ticks among {', '.join(map(str, intervals))}.")
        RampInUse(self.ramp_in_use)


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


@dataclass(frozen=True)
class ReportRequest(Request):
    """Ask for reports, so many times a second; 0: no more of them."""

    KIND = 0x03
    LAYOUT = "<B"
    rate_hz: int


@dataclass(frozen=True)
class TraceRequest(Request):
    """Ask for the instants of every k-th step of each move of an axis that begins from now on."""

    KIND = 0x04
    LAYOUT = "<BH"
    axis: int
    """TRACE_OFF: no more of them."""
    every_steps: int
    """k; 0: the controller chooses."""


@dataclass(frozen=True)
class TraceReply(Reply):
    """Which steps will be traced."""

    LAYOUT = "<H"
    every_steps: int


@dataclass(frozen=True)
class BeginRequest(Request):
    """Announce a ramp image."""

    KIND = 0x10
    LAYOUT = "<HH"
    length: int
    crc: int


@dataclass(frozen=True)
class DataRequest(Request):
    """A part of the ramp image."""

    KIND = 0x11
    HARMLESS_TWICE = False
    LAYOUT = "<H"
    TAIL = range(1, MOST_DATA + 1)
    offset: int
    data: bytes


@dataclass(frozen=True)
class DataReply(Reply):
    """How much has arrived."""

    LAYOUT = "<H"
    received_bytes: int


@dataclass(frozen=True)
class EndRequest(Request):
    """Let the ramp image be checked."""

    KIND = 0x12


@dataclass(frozen=True)
class EndReply(Reply):
    """The ramp image is sound."""

    LAYOUT = "<BB"
    axes: int
    ramps: int


@dataclass(frozen=True)
class CommitRequest(Request):
    """Store the checked ramp image, or the one on trial, and the settings in use."""

    KIND = 0x13
    HARMLESS_TWICE = False


@dataclass(frozen=True)
class ReadRequest(Request):
    """Ask for a part of a ramp image."""

    KIND = 0x14
    LAYOUT = "<BHB"
    source: int
    offset: int
    length: int


@dataclass(frozen=True)
class ReadReply(Reply):
    """A part of a ramp image."""

    LAYOUT = "<H"
    TAIL = range(MOST_DATA + 1)
    total_bytes: int
    data: bytes


@dataclass(frozen=True)
class TryRequest(Request):
    """Use the checked ramp image from now on, without storing it."""

    KIND = 0x15


@dataclass(frozen=True)
class RollBackRequest(Request):
    """Drop what was delivered or is on trial; when there is nothing of the kind, bring the previous ramp back."""

    KIND = 0x16
    HARMLESS_TWICE = False


@dataclass(frozen=True)
class ReadSettingsRequest(Request):
    """Ask for the settings in use."""

    KIND = 0x17


@dataclass(frozen=True)
class SettingsReply(Reply):
    """The settings in use, packed."""

    LAYOUT = f"<{SETTINGS_BYTES}s"
    settings: bytes


@dataclass(frozen=True)
class WriteSettingsRequest(Request):
    """Use other settings from now on, without storing them."""

    KIND = 0x18
    LAYOUT = f"<{SETTINGS_BYTES}s"
    settings: bytes


@dataclass(frozen=True)
class MoveByRequest(AxesRequest):
    """Move axes by so many steps from where they would come to rest."""

    KIND = 0x20
    HARMLESS_TWICE = False


@dataclass(frozen=True)
class MoveToRequest(AxesRequest):
    """Move axes to positions [steps]."""

    KIND = 0x21


@dataclass(frozen=True)
class RunRequest(AxesRequest):
    """Run axes at intervals [ticks], negative for backwards; 0: stop."""

    KIND = 0x22


@dataclass(frozen=True)
class LineRequest(Request):
    """Move axes by so many steps along a straight line; the one with most steps plays the ramp of an axis."""

    KIND = 0x23
    HARMLESS_TWICE = False
    LAYOUT = "<BB"
    TAIL = range(9)
    EACH = "i"
    axes: int
    ramp_axis: int
    steps: tuple[int, ...]

    def __post_init__(self) -> None:
        if self.axes.bit_count() != len(self.steps):
            raise ValueError(f"{len(self.steps)} values for {self.axes.bit_count()} axes.")

    @property
    def by_axis(self) -> dict[int, int]:
        """The steps by their axes."""
        return dict(zip(axes_of(self.axes), self.steps, strict=True))


@dataclass(frozen=True)
class SetPositionRequest(AxesRequest):
    """Call the places where axes are these positions [steps]."""

    KIND = 0x24


@dataclass(frozen=True)
class ZeroRequest(Request):
    """Call the places where axes are so many steps, and move them to 0."""

    KIND = 0x25
    HARMLESS_TWICE = False
    LAYOUT = "<BH"
    axes: int
    steps: int


@dataclass(frozen=True)
class StopRequest(Request):
    """Slow down with the ramp: all axes, or those of a mask."""

    KIND = 0x30
    TAIL = range(2)
    axes: bytes = b""
    """Nothing, or one byte."""


@dataclass(frozen=True)
class HaltRequest(Request):
    """Make no further step: all axes, or those of a mask."""

    KIND = 0x31
    TAIL = range(2)
    axes: bytes = b""
    """Nothing, or one byte."""


@dataclass(frozen=True)
class ReportNotice(Notice):
    """Where all axes of the ramp image are."""

    KIND = 0xC0
    LAYOUT = "<HB"
    TAIL = range(MOST_AXES + 1)
    EACH = "iI"
    time_ms: int
    states: int
    """Two bits an axis, axis 0 the lowest."""
    axes: tuple[tuple[int, int], ...]
    """Position [steps] and interval [ticks; 0 at rest] of each."""

    def __post_init__(self) -> None:
        for axis in range(len(self.axes)):
            self.state_of(axis)

    def state_of(self, axis: int) -> AxisState:
        """Return what an axis is doing."""
        return AxisState(self.states >> 2 * axis & 3)


@dataclass(frozen=True)
class TraceNotice(Notice):
    """The timer's values at every k-th step of a move."""

    KIND = 0xC1
    LAYOUT = "<BHI"
    TAIL = range(MOST_TRACE_VALUES + 1)
    EACH = "H"
    axis_and_last: int
    every_steps: int
    first_step: int
    values: tuple[int, ...]

    @property
    def axis(self) -> int:
        """The axis that is traced."""
        return self.axis_and_last & ~TRACE_LAST

    @property
    def is_last(self) -> bool:
        """Whether it is the last frame of this move."""
        return bool(self.axis_and_last & TRACE_LAST)


@dataclass(frozen=True)
class Refusal:
    """A reply with a status other than ok."""

    status: ReplyStatus
    detail: int = 0


R = TypeVar("R", bound=Reply)

REQUESTS: dict[int, type[Request]] = {
    request.KIND: request
    for request in (*Request.__subclasses__(), *AxesRequest.__subclasses__())
    if request is not AxesRequest
}
NOTICE_KINDS: dict[int, type[Notice]] = {notice.KIND: notice for notice in Notice.__subclasses__()}


def pack_reply(reply: Reply | Refusal) -> bytes:
    """Return a reply's body, its status included."""
    if isinstance(reply, Refusal):
        return struct.pack("<BH", reply.status, reply.detail)
    return bytes([ReplyStatus.OK]) + reply.pack()


def unpack_reply(reply_type: type[R], body: bytes) -> R | Refusal:
    """Return a reply's body as an object; ValueError for one that makes no sense."""
    if not body:
        raise ValueError("A reply without a status.")
    status = ReplyStatus(body[0])
    if status is ReplyStatus.OK:
        return reply_type.unpack(body[1:])
    if len(body) != 3:
        raise ValueError(f"A refusal of {len(body)} bytes; allowed: 3.")
    return Refusal(status, int.from_bytes(body[1:], "little"))


def unpack_notice(message: Message) -> Notice | None:
    """Return a message as a notice; None for a kind that is not known, or a body that makes no sense."""
    kind = NOTICE_KINDS.get(message.kind)
    try:
        return None if kind is None else kind.unpack(message.body)
    except ValueError:
        return None
