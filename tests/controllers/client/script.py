"""A device that follows a script of (sent, replied), and what is said in that."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from controllers.ramps import IMAGE, four_axes
from designs import design
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.stepramp.controller import StepRampController
from stepramp.controllers.stepramp.frames import FrameSplitter, crc16, encode_frame
from stepramp.controllers.stepramp.messages.body import DoneReply, Notice, Reply, Request
from stepramp.controllers.stepramp.messages.message import REPLY, Message
from stepramp.controllers.stepramp.messages.ramps import (
    BeginRequest,
    DataReply,
    DataRequest,
    EndReply,
    EndRequest,
    ReadReply,
    ReadRequest,
)
from stepramp.controllers.stepramp.messages.reply import Refusal, pack_reply
from stepramp.controllers.stepramp.messages.report import ReportRequest
from stepramp.controllers.stepramp.messages.session import Ability, HelloReply, HelloRequest
from stepramp.controllers.stepramp.messages.settings import ReadSettingsRequest, SettingsReply
from stepramp.controllers.stepramp.messages.status import StatusReply, StatusRequest
from stepramp.controllers.stepramp.push import plan_push
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.controllers.virtual.controller import HELLO as WITH_ALL

HELLO = replace(WITH_ALL, more=bytes([WITH_ALL.more[0] & ~Ability.SOFT_LIMITS, *WITH_ALL.more[1:]]))
"""Of a controller without soft limits of its own, which are four questions more."""
SESSION = 0x1234
BYTES = IMAGE.encode()
IDLE = StatusReply(0, 0, 0, 0, 0, 0, 1, crc16(BYTES), 0, 0)
NO_RAMP = StatusReply(0, 0, 0, 0, 0, 0, 0, 0, 0, 0)


def sent(request: Request, tag: int) -> Message:
    return Message(request.KIND, SESSION, tag, request.pack())


def replied(request: Request, reply: Reply | Refusal, tag: int, session: int = SESSION) -> bytes:
    return encode_frame(Message(request.KIND | REPLY, session, tag, pack_reply(reply)).pack())


def said(notice: Notice, tag: int = 0, session: int = SESSION) -> bytes:
    return encode_frame(Message(notice.KIND, session, tag, notice.pack()).pack())


def by_steps(*values: int) -> list[AxisCommand]:
    return [AxisCommand(axis, value, f"axes.{axis}.by_steps") for axis, value in enumerate(values)]


class Script:
    """A device that expects messages in an order and answers each with the bytes set against it.

    The handshake is expected first; tags count on by themselves.
    """

    def __init__(self, hello: HelloReply = HELLO, settings: StepRampSettings | None = None, image: bytes = b"") -> None:
        self.pairs: list[tuple[Message, bytes]] = [(sent(HelloRequest(), 0), replied(HelloRequest(), hello, 0))]
        self.splitter = FrameSplitter()
        self.unasked = b""
        self.noise = b""
        """What it receives after each frame."""
        self._tag = 0
        self.then(ReadSettingsRequest(), SettingsReply((settings or StepRampSettings()).pack()))
        if hello.ramp_in_use:
            self.reads(0, image)
        self.then(ReportRequest(50), DoneReply())

    def then(self, request: Request, reply: Reply | Refusal | bytes, *, again: bool = False) -> Script:
        """Expect a request with the next tag, or a repeat of the last one."""
        self._tag = self._tag if again else (self._tag + 1) % 256
        answer = reply if isinstance(reply, bytes) else replied(request, reply, self._tag)
        self.pairs.append((sent(request, self._tag), answer))
        return self

    def reads(self, source: int, image: bytes) -> Script:
        """Expect that an image is read."""
        for offset in range(0, max(1, len(image)), 48):
            self.then(ReadRequest(source, offset, 48), ReadReply(len(image), image[offset : offset + 48]))
        return self

    def delivers(self, image: bytes, staged: bytes | None = None) -> Script:
        """Expect that an image is sent and read back from RAM."""
        self.then(BeginRequest(len(image), crc16(image)), DoneReply())
        for offset in range(0, len(image), 48):
            part = image[offset : offset + 48]
            self.then(DataRequest(offset, part), DataReply(offset + len(part)))
        return self.then(EndRequest(), EndReply(1, 1)).reads(1, image if staged is None else staged)

    @property
    def tag(self) -> int:
        return self._tag

    def opened(self) -> None:
        pass

    def exchange(self, data: bytes) -> bytes:
        answer, self.unasked = self.unasked, b""
        for frame in self.splitter.feed(data + self.noise):
            expected, reply = self.pairs.pop(0)
            assert Message.unpack(frame) == expected
            answer += reply
        return answer


Connect = Callable[[Script], StepRampController]


def stored(image: bytes = BYTES) -> Script:
    """Return the script of a controller that has a ramp."""
    known = HelloReply(**{**vars(HELLO), "ramp_sequence": 1, "image_crc": crc16(image), "ramp_in_use": 1})
    return Script(known, image=image)


def four() -> Script:
    """Return the script of a controller with four axes, and that of its status."""
    script = stored(four_axes().encode())
    for axis in range(4):
        script.then(StatusRequest(axis), IDLE)
    return script


def fast_image() -> bytes:
    return plan_push(
        [
            design(
                timer__frequency_hz=16_000_000, ramp__slew_speed_steps_per_s=35_000, ramp__acceleration_steps_per_s2=1e9
            )
        ]
        * 4,
        HELLO,
        StepRampSettings(),
    ).image.encode()
