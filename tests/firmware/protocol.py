"""The serial protocol, written anew for these tests from docs/serial_protocol.md; shares nothing with the product."""

import struct
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import astuple, dataclass, field
from typing import Self

import serial

Segment = tuple[int, int, int]
"""(interval, count, add)"""

HELLO, STATUS, REPORT, TRACE = range(0x01, 0x05)
BEGIN, DATA, END, COMMIT, READ, TRY, ROLL_BACK, READ_SETTINGS, WRITE_SETTINGS = range(0x10, 0x19)
READ_LIMITS, WRITE_LIMITS = 0x19, 0x1A
MOVE_BY, MOVE_TO, RUN, LINE, SET_POSITION, ZERO, ACKNOWLEDGE, HOME = range(0x20, 0x28)
STOP, HALT = 0x30, 0x31
REPORT_NOTICE, TRACE_NOTICE = 0xC0, 0xC1
OK, UNKNOWN_KIND, BAD_LENGTH, STALE, MOVING, NO_RAMP, OUT_OF_RANGE, OUT_OF_ORDER, BAD_CRC, BAD_RAMP, BUSY, VERSION = (
    range(12)
)
TOO_FAST, STOPPED, AT_LIMIT = 12, 13, 14
IDLE, IN_MOTION, STOPPING, WRITING = range(4)
STORED, RAM, PREVIOUS = range(3)
NO_RAMP_IN_USE, STORED_IN_USE, TRIAL_IN_USE = range(3)
WRITE_FAILED, ON_TRIAL, ENABLED = 1, 2, 4
TRACE_OFF, TRACE_LAST = 255, 0x80
DATA_BYTES = 48
LARGEST_IMAGE = 440
SLOW_HZ, FAST_HZ = 2_000_000, 16_000_000
HOLD_FOR_EVER = 65535
PATIENCE_S = 10.0
"""How long an answer is waited for: a machine that does much else may hold the simulator up for more than a second."""


def crc16(data: bytes) -> int:
    crc = 0xFFFF
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x1021 if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc


def encode_frame(message: bytes) -> bytes:
    body = message + struct.pack("<H", crc16(message))
    return b"".join(bytes([len(group) + 1]) + group for group in body.split(b"\0")) + b"\0"


def decode_frame(frame: bytes) -> bytes:
    """Return the message of a frame, its zero byte included; the frame must be good."""
    body, at = b"", 0
    while frame[at]:
        body += (b"\0" if body or at else b"") + frame[at + 1 : at + frame[at]]
        at += frame[at]
    assert at == len(frame) - 1
    message, crc = body[:-2], body[-2:]
    assert struct.pack("<H", crc16(message)) == crc
    return message


def is_whole(frame: bytes) -> bool:
    """Tell whether a frame is one that was not cut."""
    try:
        decode_frame(frame)
    except (AssertionError, IndexError):
        return False
    return True


# ---- ramps and settings


def leb128(number: int) -> bytes:
    data = b""
    while number > 127:
        data += bytes([number & 127 | 128])
        number >>= 7
    return data + bytes([number])


def zigzag(number: int) -> int:
    return 2 * number if number >= 0 else -2 * number - 1


def pack_list(segments: Iterable[Segment]) -> bytes:
    data, expected, last_add = b"", 0, 0
    for interval, count, add in segments:
        data += leb128(count) + leb128(zigzag(interval - expected)) + leb128(zigzag(add - last_add))
        expected, last_add = interval + count * add, add
    return data


def expand(segments: Iterable[Segment]) -> list[int]:
    return [interval + i * add for interval, count, add in segments for i in range(count)]


def with_header(kind: int, content: bytes) -> bytes:
    """Return the content of a ramp with what stands before it in an image."""
    return struct.pack("<BH", kind, len(content)) + content


def image_of(ramps: Iterable[bytes], axes: Sequence[int] = (0,), *, fast: bool = False) -> bytes:
    """Return the ramp image of ramps, each with its header, and of the number of each axis' ramp."""
    ramps = list(ramps)
    return struct.pack("<BBBB", 2, fast, len(axes), len(ramps)) + bytes(axes) + b"".join(ramps)


@dataclass(frozen=True)
class Ramp:
    up: Sequence[Segment]
    slew: int
    down: Sequence[Segment]

    def packed(self) -> bytes:
        """Return it as a part of a ramp image."""
        same = self.up == self.down and len(self.up) > 0
        up, down = pack_list(self.up), b"" if same else pack_list(self.down)
        counts = (len(self.up), 0 if same else len(self.down))
        return with_header(0, struct.pack("<BBBIH", same, *counts, self.slew, len(up)) + up + down)

    def image(self, axes: int = 1, *, fast: bool = False) -> bytes:
        """Return the image of so many axes that all have this ramp."""
        return image_of([self.packed()], [0] * axes, fast=fast)

    def intervals(self, steps: int) -> list[int]:
        """Return the intervals of a move from rest to rest, step by step as the document has it."""
        up, down = expand(self.up), expand(self.down)
        n_up = n_down = 0
        while n_up + n_down < steps and (n_up < len(up) or n_down < len(down)):
            if n_down == len(down) or (n_up < len(up) and up[n_up] >= down[n_down]):
                n_up += 1
            else:
                n_down += 1
        return up[:n_up] + [self.slew] * (steps - n_up - n_down) + down[:n_down][::-1]


@dataclass(frozen=True)
class Settings:
    outputs: int = 0
    both_edges: int = 0
    step_inverted: int = 0
    direction_inverted: int = 0
    enable_flags: int = 0
    pulse_width_us: int = 0
    direction_setup_us: int = 30
    enable_lead_ms: int = 1
    enable_hold_ms: int = HOLD_FOR_EVER

    def packed(self) -> bytes:
        return struct.pack("<6B3H", *astuple(self))


# ---- inputs

EMERGENCY_STOP, DRIVER_FAULT, LOW_LIMIT, HIGH_LIMIT = 1, 2, 8, 12
AT_ONCE, ACTIVE_HIGH, NO_PULL_UP = 0x20, 0x40, 0x80
BY_EMERGENCY_STOP, BY_DRIVER_FAULT, BY_LATENESS = 1, 2, 4


@dataclass(frozen=True)
class InputSettings:
    """What follows the settings of the outputs; roles by input."""

    silence: int = 4
    silence_flags: int = 0
    looks: int = 4
    roles: Mapping[int, int] = field(default_factory=dict)

    def packed(self) -> bytes:
        return bytes([self.silence, self.silence_flags, self.looks, *(self.roles.get(i, 0) for i in range(9))])


@dataclass(frozen=True)
class InputsStatus:
    """The end of a status of version 3, of a controller with inputs."""

    active: int
    stopped_by: int
    known: int
    homing: int

    @classmethod
    def unpack(cls, body: bytes) -> Self:
        return cls(*struct.unpack("<HBBB", body))


# ---- messages


def for_axes(values: Mapping[int, int]) -> bytes:
    """Return the mask and the values of a request that names axes."""
    return bytes([sum(1 << axis for axis in values)]) + values_of(values)


def values_of(values: Mapping[int, int]) -> bytes:
    return b"".join(struct.pack("<i", values[axis]) for axis in sorted(values))


@dataclass(frozen=True)
class Hello:
    version: int
    firmware: tuple[int, ...]
    fast_clock_hz: int
    slow_clock_hz: int
    shortest: tuple[int, ...]
    shortest_line: tuple[int, ...]
    longest: int
    shortest_formula: int
    largest_image: int
    most_segments: int
    axes: int
    reset_cause: int
    sequence: int
    crc: int
    in_use: int

    @classmethod
    def unpack(cls, body: bytes) -> Self:
        v = struct.unpack("<4B2I4H3HI2H3BIHB", body)
        return cls(v[0], v[1:4], v[4], v[5], v[6:10], v[10:13], *v[13:])


@dataclass(frozen=True)
class Status:
    state: int
    axis_state: int
    position: int
    target: int
    interval: int
    steps_made: int
    sequence: int
    crc: int
    flags: int
    starved: int

    @classmethod
    def unpack(cls, body: bytes) -> Self:
        return cls(*struct.unpack("<BBiiIIIHBB", body))

    @property
    def write_failed(self) -> bool:
        return bool(self.flags & WRITE_FAILED)


@dataclass(frozen=True)
class Report:
    time_ms: int
    states: tuple[int, ...]
    positions: tuple[int, ...]
    intervals: tuple[int, ...]

    @classmethod
    def unpack(cls, body: bytes) -> Self:
        time_ms, states = struct.unpack("<HB", body[:3])
        axes = list(struct.iter_unpack("<iI", body[3:]))
        return cls(
            time_ms,
            tuple(states >> 2 * axis & 3 for axis in range(4)),
            tuple(position for position, _ in axes),
            tuple(interval for _, interval in axes),
        )


@dataclass(frozen=True)
class Trace:
    axis: int
    is_last: bool
    every: int
    first_step: int
    values: tuple[int, ...]

    @classmethod
    def unpack(cls, body: bytes) -> Self:
        axis, every, first_step = struct.unpack("<BHI", body[:7])
        values = tuple(value for (value,) in struct.iter_unpack("<H", body[7:]))
        return cls(axis & 0x7F, bool(axis & TRACE_LAST), every, first_step, values)

    def by_step(self) -> dict[int, int]:
        return {self.first_step + i * self.every: value for i, value in enumerate(self.values)}


def image_parts(image: bytes) -> list[bytes]:
    """Return the bodies of the data requests that deliver an image."""
    offsets = range(0, len(image), DATA_BYTES)
    return [struct.pack("<H", offset) + image[offset : offset + DATA_BYTES] for offset in offsets]


class Client:
    """Speaks to a controller over a serial port. `request` returns the reply's body with its leading status; notices
    that come meanwhile are kept in `notices`."""

    def __init__(self, port: str, session: int = 0x1234) -> None:
        self.notices: list[bytes] = []
        self._port = serial.Serial(port, 115200, timeout=PATIENCE_S)
        self._session = session
        self._tag = 0

    def request(self, kind: int, body: bytes = b"") -> bytes:
        self._tag = (self._tag + 1) & 0xFF
        self.send(kind, body)
        message = self._read_reply()
        assert message[:4] == struct.pack("<BHB", kind | 0x80, self._session, self._tag)
        return message[4:]

    def _read_reply(self) -> bytes:
        while (message := self._read_message())[0] >= REPORT_NOTICE:
            self.notices.append(message)
        return message

    def _read_message(self) -> bytes:
        """Return the next message; a frame that was cut for a stop is none."""
        while not is_whole(frame := self.read_frame()):
            pass
        return decode_frame(frame)

    def read_notice(self) -> bytes:
        """Return the next report or trace, one that was kept first."""
        return self.notices.pop(0) if self.notices else self._read_message()

    def send_raw(self, data: bytes) -> None:
        self._port.write(data)

    def send(self, kind: int, body: bytes = b"") -> None:
        self._port.write(encode_frame(struct.pack("<BHB", kind, self._session, self._tag) + body))

    def read_frame(self) -> bytes:
        frame: bytes = self._port.read_until(b"\0")
        assert frame.endswith(b"\0"), f"no answer, only {frame!r}"
        return frame

    def expect_ok(self, kind: int, body: bytes = b"") -> bytes:
        reply = self.request(kind, body)
        assert reply[0] == OK, f"refused with status {reply[0]}, detail {reply[1:].hex()}"
        return reply[1:]

    def hello(self) -> Hello:
        return Hello.unpack(self.expect_ok(HELLO, b"\x02"))

    def hello_until_answered(self) -> Hello:
        """As a client does that has just opened a port: a lone zero, then hello every 250 ms."""
        self._port.timeout = 0.25
        for _ in range(20):
            self._port.write(b"\0")
            self.send(HELLO, b"\x02")
            if self._port.read_until(b"\0").endswith(b"\0"):
                self._port.timeout = PATIENCE_S
                return self._hello_behind_late_answers()
        raise AssertionError("no answer to 20 hellos")

    def _hello_behind_late_answers(self) -> Hello:
        """Say hello once more; what a busy machine was given up on too early may be answered first."""
        self._tag = (self._tag + 1) & 0xFF
        self.send(HELLO, b"\x02")
        while (message := self._read_reply())[3] != self._tag:
            pass
        assert message[4] == OK
        return Hello.unpack(message[5:])

    def status(self, axis: int = 0) -> Status:
        return Status.unpack(self.expect_ok(STATUS, bytes([axis])))

    def deliver(self, image: bytes) -> None:
        """Begin, data, end."""
        self.expect_ok(BEGIN, struct.pack("<HH", len(image), crc16(image)))
        for part in image_parts(image):
            self.expect_ok(DATA, part)
        self.expect_ok(END)

    def push(self, ramp: Ramp | bytes) -> None:
        """Store an image; a ramp: the image of one axis."""
        self.deliver(ramp.image() if isinstance(ramp, Ramp) else ramp)
        self.expect_ok(COMMIT)
        assert not self.wait_while(WRITING).write_failed

    def try_out(self, ramp: Ramp | bytes) -> None:
        self.deliver(ramp.image() if isinstance(ramp, Ramp) else ramp)
        self.expect_ok(TRY)

    def write_settings(self, settings: Settings) -> None:
        self.expect_ok(WRITE_SETTINGS, settings.packed())

    def read(self, source: int) -> bytes:
        data = b""
        while part := self.expect_ok(READ, struct.pack("<BHB", source, len(data), DATA_BYTES))[2:]:
            data += part
        return data

    def move_by(self, steps: int, axis: int = 0) -> None:
        self.expect_ok(MOVE_BY, for_axes({axis: steps}))

    def move_to(self, position: int, axis: int = 0) -> None:
        self.expect_ok(MOVE_TO, for_axes({axis: position}))

    def wait_while(self, *states: int) -> Status:
        while (status := self.status()).state in states:
            time.sleep(0.002)
        return status

    def wait_until_idle(self) -> Status:
        return self.wait_while(IN_MOTION)

    def close(self) -> None:
        self._port.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
