"""Frames to the controller, and what it answers."""

import struct

from firmware import protocol as p
from firmware.controller_host import Driver
from firmware.protocol import Hello, Ramp, Status, decode_frame, encode_frame, is_whole

SESSION = 0xBEEF
NOTICES = (p.REPORT_NOTICE, p.TRACE_NOTICE)
BYTE_US = 1389 / 16
"""What a round of the driver takes."""
WHOLE_COMMIT = 50_000
"""Rounds that are enough for the largest commit."""


class Controller:
    """Frames to a controller on this machine."""

    def __init__(self, driver: Driver) -> None:
        self.driver = driver
        self.tag = 0
        self.notices: list[bytes] = []
        self.half_frame = b""

    def frame(self, kind: int, body: bytes = b"", *, session: int = SESSION, tag: int | None = None) -> bytes:
        """Return a request as a frame; one with a new tag unless it is given."""
        if tag is None:
            self.tag = tag = (self.tag + 1) & 0xFF
        return encode_frame(struct.pack("<BHB", kind, session, tag) + body)

    def replies_to(self, data: bytes) -> list[bytes]:
        """Send bytes; return the messages of the replies. Notices are kept."""
        messages = messages_of(self.driver.send(data))
        self.notices += [message for message in messages if message[0] in NOTICES]
        return [message for message in messages if message[0] not in NOTICES]

    def send(self, kind: int, body: bytes = b"", *, session: int = SESSION, tag: int | None = None) -> bytes:
        """Send a request; return the reply's status and body."""
        frame = self.frame(kind, body, session=session, tag=tag)
        (reply,) = self.replies_to(frame)
        assert reply[:4] == struct.pack("<BHB", kind | 0x80, session, self.tag if tag is None else tag)
        return reply[4:]

    def ok(self, kind: int, body: bytes = b"") -> bytes:
        reply = self.send(kind, body)
        assert reply[0] == p.OK, reply.hex()
        return reply[1:]

    def refused(self, kind: int, body: bytes = b"", **options: int) -> tuple[int, int]:
        """Return status and detail."""
        return struct.unpack("<BH", self.send(kind, body, **options))

    def deliver(self, image: bytes) -> None:
        self.ok(p.BEGIN, struct.pack("<HH", len(image), p.crc16(image)))
        for part in p.image_parts(image):
            reply = self.ok(p.DATA, part)
            assert struct.unpack("<H", reply)[0] == struct.unpack("<H", part[:2])[0] + len(part) - 2

    def check(self, image: bytes) -> None:
        self.deliver(image)
        assert self.ok(p.END) == image[2:4]

    def push(self, ramp: Ramp | bytes) -> None:
        self.check(ramp.image() if isinstance(ramp, Ramp) else ramp)
        self.ok(p.COMMIT)
        self.run(WHOLE_COMMIT)

    def run(self, rounds: int) -> None:
        self.driver.ask("poll", rounds)

    def hello(self) -> Hello:
        return Hello.unpack(self.ok(p.HELLO, b"\2"))

    def status(self, axis: int = 0) -> Status:
        return Status.unpack(self.ok(p.STATUS, bytes([axis])))

    def read(self, source: int = p.STORED) -> bytes:
        data = b""
        while part := self.ok(p.READ, struct.pack("<BHB", source, len(data), 48))[2:]:
            data += part
        return data

    def settings(self) -> bytes:
        return self.ok(p.READ_SETTINGS)

    def steps(self) -> list[int]:
        """Return where the pins say that the motors are."""
        return [int(word) for word in self.driver.ask("steps").split()]

    def run_until_idle(self) -> Status:
        for _ in range(1000):
            self.run(2000)
            status = self.status()
            if status.state == p.IDLE:
                return status
        raise AssertionError("It moves on and on.")


def messages_of(sent: bytes) -> list[bytes]:
    assert sent == b"" or sent.endswith(b"\0")
    return [decode_frame(frame + b"\0") for frame in sent.split(b"\0")[:-1]]


def started(driver: Driver) -> Controller:
    """Switch the controller on and begin a session."""
    driver.ask("begin")
    controller = Controller(driver)
    controller.hello()
    return controller


def timed_messages(controller: Controller, rounds: int, data: bytes = b"") -> list[tuple[int, bytes]]:
    """Return what is sent in so many rounds, while bytes come in at the first of them: messages, and the round of the
    last byte of each."""
    messages, frame = [], controller.half_frame
    for word in controller.driver.ask("run", rounds, data.hex()).split():
        at, byte = word.split(":")
        frame += bytes.fromhex(byte)
        if byte == "00":
            messages.append((int(at), frame))
            frame = b""
    controller.half_frame = frame
    return [(at, decode_frame(frame)) for at, frame in messages if is_whole(frame)]
