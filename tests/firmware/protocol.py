"""The serial protocol, written anew for these tests from docs/serial_protocol.md; shares nothing with the product."""

import struct
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Self

import serial

Segment = tuple[int, int, int]
"""(interval, count, add)"""

HELLO, STATUS, BEGIN, DATA, END, COMMIT, READ, MOVE_BY, MOVE_TO, STOP, HALT = (
    0x01, 0x02, 0x10, 0x11, 0x12, 0x13, 0x14, 0x20, 0x21, 0x30, 0x31,
)  # fmt: skip
OK, UNKNOWN_KIND, BAD_LENGTH, STALE, MOVING, NO_RAMP, OUT_OF_RANGE, OUT_OF_ORDER, BAD_CRC, BAD_RAMP, BUSY, VERSION = (
    range(12)
)
IDLE, IN_MOTION, STOPPING, WRITING = range(4)


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


@dataclass(frozen=True)
class Ramp:
    up: Sequence[Segment]
    slew: int
    down: Sequence[Segment]

    def image(self) -> bytes:
        same = self.up == self.down and len(self.up) > 0
        down = [] if same else self.down
        return struct.pack("<BBBBI", 1, same, len(self.up), len(down), self.slew) + pack_list(self.up) + pack_list(down)

    def intervals(self, steps: int) -> list[int]:
        """Return the intervals of a move, step by step as the document has it."""
        up, down = expand(self.up), expand(self.down)
        n_up = n_down = 0
        while n_up + n_down < steps and (n_up < len(up) or n_down < len(down)):
            if n_down == len(down) or (n_up < len(up) and up[n_up] >= down[n_down]):
                n_up += 1
            else:
                n_down += 1
        return up[:n_up] + [self.slew] * (steps - n_up - n_down) + down[:n_down][::-1]


def expand(segments: Iterable[Segment]) -> list[int]:
    return [interval + i * add for interval, count, add in segments for i in range(count)]


@dataclass(frozen=True)
class Status:
    state: int
    position: int
    target: int
    interval: int
    steps_made: int
    sequence: int
    crc: int
    write_failed: int


class Client:
    """Speaks to a controller over a serial port. `request` returns the reply's body with its leading status."""

    def __init__(self, port: str, session: int = 0x1234) -> None:
        self._port = serial.Serial(port, 115200, timeout=1.0)
        self._session = session
        self._tag = 0

    def request(self, kind: int, body: bytes = b"") -> bytes:
        self._tag = (self._tag + 1) & 0xFF
        self.send(kind, body)
        message = decode_frame(self.read_frame())
        assert message[:4] == struct.pack("<BHB", kind | 0x80, self._session, self._tag)
        return message[4:]

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

    def hello(self) -> bytes:
        return self.expect_ok(HELLO, b"\x01")

    def hello_until_answered(self) -> bytes:
        """As a client does that has just opened a port: a lone zero, then hello every 250 ms."""
        self._port.timeout = 0.25
        for _ in range(20):
            self._port.write(b"\0")
            self.send(HELLO, b"\x01")
            if self._port.read_until(b"\0").endswith(b"\0"):
                self._port.timeout = 1.0
                return self.hello()
        raise AssertionError("no answer to 20 hellos")

    def status(self) -> Status:
        return Status(*struct.unpack("<BiiIIIHB", self.expect_ok(STATUS)))

    def stage(self, image: bytes) -> None:
        self.expect_ok(BEGIN, struct.pack("<HH", len(image), crc16(image)))
        for offset in range(0, len(image), 48):
            self.expect_ok(DATA, struct.pack("<H", offset) + image[offset : offset + 48])
        self.expect_ok(END)

    def push(self, ramp: Ramp) -> None:
        self.stage(ramp.image())
        self.expect_ok(COMMIT)
        assert self.wait_while(WRITING).write_failed == 0

    def read(self, source: int) -> bytes:
        data = b""
        while part := self.expect_ok(READ, struct.pack("<BHB", source, len(data), 48))[2:]:
            data += part
        return data

    def move_by(self, steps: int) -> None:
        self.expect_ok(MOVE_BY, struct.pack("<i", steps))

    def move_to(self, position: int) -> None:
        self.expect_ok(MOVE_TO, struct.pack("<i", position))

    def wait_while(self, *states: int) -> Status:
        while (status := self.status()).state in states:
            time.sleep(0.002)
        return status

    def wait_until_idle(self) -> Status:
        return self.wait_while(IN_MOTION, STOPPING)

    def close(self) -> None:
        self._port.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
