"""A serial port to a controller for tests of the protocol itself: single frames, without repeats."""

from __future__ import annotations

import time
from collections.abc import Callable

from stepramp.controllers.stepramp.frames import FrameSplitter, crc16, encode_frame
from stepramp.controllers.stepramp.messages.body import DoneReply, Notice, Reply, Request
from stepramp.controllers.stepramp.messages.kinds import NOTICE_KINDS, unpack_notice
from stepramp.controllers.stepramp.messages.message import REPLY, Message
from stepramp.controllers.stepramp.messages.ramps import (
    BeginRequest,
    CommitRequest,
    DataReply,
    DataRequest,
    EndReply,
    EndRequest,
    ReadReply,
    ReadRequest,
    TryRequest,
)
from stepramp.controllers.stepramp.messages.reply import Refusal, unpack_reply
from stepramp.controllers.stepramp.messages.session import HelloReply, HelloRequest
from stepramp.controllers.stepramp.messages.status import AxisState, MachineState, StatusReply, StatusRequest
from stepramp.controllers.stepramp.ramp_image import RampImage
from stepramp.link.serial_port import SerialPort

SESSION = 0xBEEF
REPLY_TIMEOUT_S = 2.0
PATIENCE_S = 60.0


class Line:
    """A port to the controller, with a session: requests go out, replies come back, notices pile up."""

    def __init__(self, port: str) -> None:
        self.port = SerialPort(port)
        self.notices: list[tuple[Message, Notice | None]] = []
        self._splitter = FrameSplitter()
        self._waiting: list[Message] = []
        self._tag = 0
        self.write(b"\0")
        self.hello()

    def hello(self) -> HelloReply:
        """Say hello, to a controller of an older version in that one."""
        self._tag = 0
        said = self.ask(HelloRequest(), HelloReply)
        return said if isinstance(said, HelloReply) else self.good(HelloRequest(said.detail), HelloReply)

    def write(self, data: bytes) -> None:
        self.port.write(data)

    def read(self, timeout_s: float = REPLY_TIMEOUT_S) -> Message | None:
        """Return the next message that is no notice."""
        deadline = time.monotonic() + timeout_s
        while True:
            while self._waiting:
                message = self._waiting.pop(0)
                if message.kind not in NOTICE_KINDS:
                    return message
                self.notices.append((message, unpack_notice(message)))
            left_s = deadline - time.monotonic()
            if left_s <= 0:
                return None
            messages = (Message.unpack(frame) for frame in self._splitter.feed(self.port.read(left_s)))
            self._waiting += [message for message in messages if message is not None]

    def hear(self, for_s: float) -> None:
        """Take notices for a while; nothing else may come."""
        assert self.read(for_s) is None

    def exchange(self, message: Message) -> Message | None:
        self.write(encode_frame(message.pack()))
        return self.read()

    def ask(self, request: Request, reply_type: type[Reply] = DoneReply) -> Reply | Refusal:
        self._tag = (self._tag + 1) % 256
        reply = self.exchange(Message(request.KIND, SESSION, self._tag, request.pack()))
        assert reply is not None
        assert (reply.kind, reply.session, reply.tag) == (request.KIND | REPLY, SESSION, self._tag)
        return unpack_reply(reply_type, reply.body)

    def good(self, request: Request, reply_type: type = DoneReply) -> Reply:
        reply = self.ask(request, reply_type)
        assert isinstance(reply, reply_type), reply
        return reply

    def status(self, axis: int = 0) -> StatusReply:
        return self.good(StatusRequest(axis), StatusReply)

    def wait_until(self, condition: Callable[[StatusReply], bool], axis: int = 0) -> StatusReply:
        deadline = time.monotonic() + PATIENCE_S
        while not condition(status := self.status(axis)):
            assert time.monotonic() < deadline, status
        return status

    def wait_for_rest(self, axis: int = 0) -> StatusReply:
        """Wait until no axis moves and nothing is written; return what an axis then says."""
        return self.wait_until(lambda status: status.state == MachineState.IDLE, axis)

    def wait_for_axis(self, axis: int) -> StatusReply:
        """Wait until one axis is at rest."""
        return self.wait_until(lambda status: status.axis_state == AxisState.IDLE, axis)

    def deliver(self, image: bytes, crc: int | None = None) -> Reply | Refusal:
        self.good(BeginRequest(len(image), crc16(image) if crc is None else crc))
        for offset in range(0, len(image), 48):
            self.good(DataRequest(offset, image[offset : offset + 48]), DataReply)
        return self.ask(EndRequest(), EndReply)

    def use(self, image: RampImage) -> None:
        """Have an image used without storing it, which is quick."""
        assert isinstance(self.deliver(image.encode()), EndReply)
        self.good(TryRequest())

    def store(self, image: RampImage) -> None:
        assert isinstance(self.deliver(image.encode()), EndReply)
        self.good(CommitRequest())
        self.wait_for_rest()

    def read_image(self, source: int = 0) -> bytes:
        data = b""
        while (part := self.good(ReadRequest(source, len(data), 48), ReadReply)).data:
            data += part.data
        return data
