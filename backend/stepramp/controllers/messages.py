"""Messages: requests and replies as objects, and as bytes. What they mean is in docs/serial_protocol.md.

Each body is a dataclass whose fields stand in the order of its layout; a body that ends in bytes has them as its last
field. Nothing here reads or writes a port.
"""

import struct
from dataclasses import astuple, dataclass, fields
from enum import IntEnum
from typing import ClassVar, Self, TypeVar

PROTOCOL_VERSION = 1
REPLY = 0x80
MOST_DATA = 48
"""Most bytes of a ramp image in one message."""
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


class MotorState(IntEnum):
    """What a controller is doing."""

    IDLE = 0
    MOVING = 1
    STOPPING = 2
    WRITING = 3


class ReadSource(IntEnum):
    """What a read reads."""

    STORED = 0
    STAGED = 1


@dataclass(frozen=True)
class Message:
    """A request or reply with its header; the body still bytes."""

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
    """What follows the header. LAYOUT is that of `struct`; TAIL the numbers of bytes that may follow it."""

    LAYOUT: ClassVar[str] = "<"
    TAIL: ClassVar[range] = range(1)

    def pack(self) -> bytes:
        """Return the body as bytes."""
        values = astuple(self)
        tail = values[-1] if len(self.TAIL) > 1 else b""
        fixed = values[:-1] if len(self.TAIL) > 1 else values
        return struct.pack(self.LAYOUT, *fixed) + tail

    @classmethod
    def unpack(cls, data: bytes) -> Self:
        """Return bytes as a body; ValueError when their number is wrong."""
        size = struct.calcsize(cls.LAYOUT)
        if len(data) - size not in cls.TAIL:
            raise ValueError(f"{cls.__name__} of {len(data)} bytes; allowed: from {size + cls.TAIL[0]}.")
        values = (*struct.unpack_from(cls.LAYOUT, data), data[size:])
        return cls(**{field.name: value for field, value in zip(fields(cls), values, strict=False)})


class Request(Body):
    """The body of a request."""

    KIND: ClassVar[int]


class Reply(Body):
    """The body of a reply, after its status."""


@dataclass(frozen=True)
class DoneReply(Reply):
    """Done, or begun: the reply to requests that ask for nothing back."""


@dataclass(frozen=True)
class MoveReply(Reply):
    """Moving, or there already."""

    LAYOUT = "<i"
    target_steps: int


@dataclass(frozen=True)
class HelloRequest(Request):
    """Begin a session."""

    KIND = 0x01
    LAYOUT = "<B"
    protocol_version: int = PROTOCOL_VERSION


@dataclass(frozen=True)
class HelloReply(Reply):
    """What the controller is, what it can do, and which ramp it has."""

    LAYOUT = "<BBBBIIIHHBIH"
    protocol_version: int
    firmware_major: int
    firmware_minor: int
    firmware_patch: int
    timer_frequency_hz: int
    shortest_interval_ticks: int
    longest_interval_ticks: int
    largest_image_bytes: int
    most_segments: int
    axes: int
    ramp_sequence: int
    ramp_crc: int

    def __post_init__(self) -> None:
        if not self.timer_frequency_hz:
            raise ValueError("A timer of 0 Hz.")

    @property
    def intervals_ticks(self) -> range:
        """The intervals that the controller can play [ticks]."""
        return range(self.shortest_interval_ticks, self.longest_interval_ticks + 1)


@dataclass(frozen=True)
class StatusRequest(Request):
    """Ask what the controller is doing."""

    KIND = 0x02


@dataclass(frozen=True)
class StatusReply(Reply):
    """What the controller is doing."""

    LAYOUT = "<BiiIIIHB"
    state: int
    position_steps: int
    target_steps: int
    interval_ticks: int
    steps_made: int
    ramp_sequence: int
    ramp_crc: int
    write_result: int

    def __post_init__(self) -> None:
        MotorState(self.state)


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
    up_segments: int
    down_segments: int


@dataclass(frozen=True)
class CommitRequest(Request):
    """Store the checked ramp image."""

    KIND = 0x13


@dataclass(frozen=True)
class ReadRequest(Request):
    """Ask for a part of the stored or of the delivered ramp image."""

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
class MoveByRequest(Request):
    """Move by so many steps."""

    KIND = 0x20
    LAYOUT = "<i"
    steps: int


@dataclass(frozen=True)
class MoveToRequest(Request):
    """Move to a position."""

    KIND = 0x21
    LAYOUT = "<i"
    position_steps: int


@dataclass(frozen=True)
class StopRequest(Request):
    """Slow down with the ramp."""

    KIND = 0x30


@dataclass(frozen=True)
class HaltRequest(Request):
    """Make no further step."""

    KIND = 0x31


@dataclass(frozen=True)
class Refusal:
    """A reply with a status other than ok."""

    status: ReplyStatus
    detail: int = 0


R = TypeVar("R", bound=Reply)

REQUESTS: dict[int, type[Request]] = {request.KIND: request for request in Request.__subclasses__()}


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
