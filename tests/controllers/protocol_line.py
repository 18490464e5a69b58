"""A serial port to a controller for tests of the protocol itself: single frames, without repeats."""

from __future__ import annotations

import time

from stepramp.controllers.frames import FrameSplitter, crc16, encode_frame
from stepramp.controllers.messages import (
    REPLY,
    BeginRequest,
    CommitRequest,
    DataReply,
    DataRequest,
    DoneReply,
    EndReply,
    EndRequest,
    HelloReply,
    HelloRequest,
    Message,
    MotorState,
    ReadReply,
    ReadRequest,
    Refusal,
    Reply,
    Request,
    StatusReply,
    StatusRequest,
    unpack_reply,
)
from stepramp.controllers.ramp_image import RampImage
from stepramp.link.serial_port import SerialPort

SESSION = 0xBEEF
REPLY_TIMEOUT_S = 2.0
PATIENCE_S = 20.0


class Line:
    """A port to the controller, with a session: requests go out, replies come back."""

    def __init__(self, port: str) -> None:
        self.port = SerialPort(port)
        self._splitter = FrameSplitter()
        self._tag = 0
        self.write(b"\0")
        self.hello()

    def hello(self) -> HelloReply:
        self._tag = 0
        return self.good(HelloRequest(), HelloReply)

    def write(self, data: bytes) -> None:
        self.port.write(data)

    def read(self, timeout_s: float = REPLY_TIMEOUT_S) -> Message | None:
        deadline = time.monotonic() + timeout_s
        while (left_s := deadline - time.monotonic()) > 0:
            for frame in self._splitter.feed(self.port.read(left_s)):
                return Message.unpack(frame)
        return None

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

    def status(self) -> StatusReply:
        return self.good(StatusRequest(), StatusReply)

    def wait_for(self, state: MotorState) -> StatusReply:
        deadline = time.monotonic() + PATIENCE_S
        while (status := self.status()).state != state:
            assert time.monotonic() < deadline, status
        return status

    def deliver(self, image: bytes, crc: int | None = None) -> Reply | Refusal:
        self.good(BeginRequest(len(image), crc16(image) if crc is None else crc))
        for offset in range(0, len(image), 48):
            self.good(DataRequest(offset, image[offset : offset + 48]), DataReply)
        return self.ask(EndRequest(), EndReply)

    def store(self, image: RampImage) -> None:
        assert isinstance(self.deliver(image.encode()), EndReply)
        self.good(CommitRequest())
        self.wait_for(MotorState.IDLE)

    def stored(self) -> bytes:
        data = b""
        while (part := self.good(ReadRequest(0, len(data), 48), ReadReply)).data:
            data += part.data
        return data
