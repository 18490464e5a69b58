"""Requests and their answers."""

import struct
from collections.abc import Iterable
from dataclasses import dataclass

from firmware.checker import CYCLES_PER_S
from firmware.protocol import HALT, LINE, MOVE_BY, MOVE_TO, OK, REPORT_NOTICE, RUN, STOP, decode_frame
from simulator.avr import Frame

BITS_OF_BYTE, BAUD = 10, 115_200
IN_TRANSMITTER_CYCLES = 2 * BITS_OF_BYTE * CYCLES_PER_S / BAUD
"""The last two bytes may still be on their way when the last one has been given to the transmitter."""

NO_ANSWER = 255
ORDERS = (MOVE_BY, MOVE_TO, RUN, LINE)


@dataclass(frozen=True)
class Exchange:
    """A request and its answer."""

    kind: int
    body: bytes
    came: int
    """When its first bit came [cycles]."""
    arrived: int
    """When it was there."""
    answered: int
    """When its answer began."""
    gone: float
    """When its answer had gone."""
    status: int
    reply: bytes
    """The rest of the answer's body."""

    @property
    def is_granted(self) -> bool:
        return self.status == OK

    @property
    def values(self) -> dict[int, int]:
        """Return the number for each axis that it names."""
        axes = [axis for axis in range(4) if self.body[0] >> axis & 1]
        return dict(zip(axes, (v for (v,) in struct.iter_unpack("<i", self.body[-4 * len(axes) :])), strict=True))

    @property
    def targets(self) -> dict[int, int]:
        """Return the targets that it is answered with."""
        return dict(zip(self.values, (v for (v,) in struct.iter_unpack("<i", self.reply)), strict=True))

    def concerns(self, axis: int) -> bool:
        return self.kind in (*ORDERS, STOP, HALT) and (not self.body or bool(self.body[0] >> axis & 1))


def message_of(frame: Frame) -> bytes | None:
    """Return the message of a frame; None of one that was cut short, so that a stop's reply goes at once."""
    try:
        return decode_frame(frame.data)
    except (AssertionError, IndexError):
        assert not frame.is_sent
        return None


def exchanges(frames: Iterable[Frame]) -> list[Exchange]:
    """Return the requests of a conversation; those that were not answered have the status NO_ANSWER."""
    found, asked = list[Exchange](), dict[bytes, Frame]()
    for frame in frames:
        message = message_of(frame)
        if message is None:
            continue
        if frame.is_sent:
            asked[message[:4]] = frame
        elif message[0] < REPORT_NOTICE:
            request = asked.pop(bytes([message[0] & 0x7F]) + message[1:4])
            body = decode_frame(request.data)[4:]
            times = (request.begin, request.end, frame.begin, frame.end + IN_TRANSMITTER_CYCLES)
            found.append(Exchange(message[0] & 0x7F, body, *times, message[4], message[5:]))
    for header, request in asked.items():
        body, end = decode_frame(request.data)[4:], request.end
        found.append(Exchange(header[0], body, request.begin, end, end, end, NO_ANSWER, b""))
    return sorted(found, key=lambda one: one.came)
