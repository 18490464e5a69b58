"""What talks at the other end, and makes no sense: never the client's fault, and never a mistake of ours."""

from __future__ import annotations

import os
import select
import threading
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import pytest

from controllers.ramps import IMAGE
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.stepramp import conversation
from stepramp.controllers.stepramp.controller import StepRampController
from stepramp.controllers.stepramp.frames import FrameSplitter, encode_frame
from stepramp.controllers.stepramp.messages.body import Reply
from stepramp.controllers.stepramp.messages.message import REPLY, Message
from stepramp.controllers.stepramp.messages.motion import MoveByRequest, TargetsReply
from stepramp.controllers.stepramp.messages.reply import pack_reply
from stepramp.controllers.stepramp.messages.session import HelloRequest
from stepramp.controllers.stepramp.messages.settings import ReadSettingsRequest, SettingsReply
from stepramp.controllers.stepramp.settings import OFFSETS, StepRampSettings
from stepramp.controllers.virtual.controller import HELLO, VirtualController
from stepramp.errors import DeviceLost, Rejected
from stepramp.link.protocol_sim import VirtualDevice
from stepramp.link.serial_port import SerialPort

PlugIn = Callable[[VirtualDevice], str]


class Garbling:
    """A virtual controller in a hurry; what it says in messages of one kind is replaced."""

    def __init__(self, kind: int, body: bytes) -> None:
        self._kind, self._body = kind, body
        self._controller = VirtualController(lambda: 50 * time.monotonic())
        self._splitter = FrameSplitter()

    def opened(self) -> None:
        self._controller.opened()

    def exchange(self, sent: bytes) -> bytes:
        messages = [Message.unpack(each) for each in self._splitter.feed(self._controller.exchange(sent))]
        return b"".join(encode_frame(self._said(each).pack()) for each in messages if each is not None)

    def _said(self, message: Message) -> Message:
        if message.kind != self._kind:
            return message
        return Message(message.kind, message.session, message.tag, self._body)


def reply_to(request: type, reply: Reply) -> tuple[int, bytes]:
    return request.KIND | REPLY, pack_reply(reply)


def settings_with(name: str, value: int) -> bytes:
    packed = bytearray(StepRampSettings().pack())
    packed[OFFSETS[name]] = value
    return bytes(packed)


@pytest.mark.parametrize(
    ("name", "value"), [("pulse_width_us", 200), ("outputs", 7), ("enable_level", 2), ("both_edges", 0xF0)]
)
def test_settings_without_sense_are_the_controllers_fault(plug_in: PlugIn, name: str, value: int) -> None:
    kind, body = reply_to(ReadSettingsRequest, SettingsReply(settings_with(name, value)))
    controller = StepRampController(SerialPort(plug_in(Garbling(kind, body))))
    with pytest.raises(DeviceLost, match=f"The controller at sim://.* has settings without sense: {name}") as caught:
        controller.connect()
    assert not isinstance(caught.value, Rejected)


@pytest.mark.parametrize("count", [0, 2, 4])
def test_more_or_fewer_targets_than_axes_are_the_controllers_fault(plug_in: PlugIn, count: int) -> None:
    kind, body = reply_to(MoveByRequest, TargetsReply((5,) * count))
    controller = StepRampController(SerialPort(plug_in(Garbling(kind, body))))
    controller.connect()
    controller.try_out(IMAGE.encode())
    with pytest.raises(DeviceLost, match=f"answers without sense: {count} targets for 1 axes"):
        controller.move_by([AxisCommand(0, 5, "by_steps")])


@pytest.mark.parametrize("at", [slice(13, 15), slice(27, 31), slice(31, 33)], ids=["shortest", "longest", "by formula"])
def test_intervals_of_nothing_are_the_controllers_fault(plug_in: PlugIn, at: slice) -> None:
    said = bytearray(pack_reply(HELLO))
    assert any(said[at])
    said[at] = bytes(at.stop - at.start)
    controller = StepRampController(SerialPort(plug_in(Garbling(HelloRequest.KIND | REPLY, bytes(said)))))
    with pytest.raises(DeviceLost, match="answers without sense: Intervals of 0 ticks"):
        controller.connect()


@pytest.mark.parametrize("speed", [1e-310, 5e-324, 1e-5, -1e-310])
def test_speeds_slower_than_the_slowest_are_refused(controller: StepRampController, speed: float) -> None:
    controller.try_out(IMAGE.encode())
    with pytest.raises(Rejected) as caught:
        controller.run([AxisCommand(0, speed, "speed_steps_per_s")])
    [rejection] = caught.value.rejections
    assert (rejection.field, rejection.value) == ("speed_steps_per_s", speed)
    # The longest interval is some ticks less than 2^31, and what is told is rounded to what is possible.
    limits = rejection.limits
    assert limits is not None
    assert limits.lowest == pytest.approx(16_000_000 / (2**31 - 1), rel=1e-8)
    assert limits.lowest >= 16_000_000 / (2**31 - 1)
    assert rejection.allowed.startswith("a number from 0.00745058")
    assert rejection.allowed.endswith(" steps/s either way, or 0")


@contextmanager
def talking(answer: Callable[[bytes], bytes]) -> Iterator[str]:
    """Plug in something that answers whatever it hears, and return its port."""
    far_end, near_end = os.openpty()
    tty.setraw(near_end)
    ended = threading.Event()

    def talk() -> None:
        while not ended.is_set():
            heard = os.read(far_end, 4096) if select.select([far_end], [], [], 0.005)[0] else b""
            os.write(far_end, answer(heard))

    thread = threading.Thread(target=talk)
    thread.start()
    try:
        yield os.ttyname(near_end)
    finally:
        ended.set()
        thread.join()
        os.close(near_end)
        os.close(far_end)


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (lambda _: b"", "Nothing answers at {port}: is it a StepRamp controller, and has it power?"),
        (lambda heard: b"ok\r\n" if heard else b"", "Something talks at {port}, but it is not a StepRamp controller."),
        (lambda _: b"\0\x03ab\0", "Something talks at {port}, but it is not a StepRamp controller."),
        (lambda heard: heard, "Something talks at {port}, but it is not a StepRamp controller."),
    ],
    ids=["silent", "another program", "chatter in frames", "a cable that leads back"],
)
def test_what_is_no_controller_is_told_apart(
    monkeypatch: pytest.MonkeyPatch, answer: Callable[[bytes], bytes], message: str
) -> None:
    monkeypatch.setattr(conversation, "MOST_HELLOS", 3)
    monkeypatch.setattr(conversation, "HELLO_INTERVAL_S", 0.05)
    with talking(answer) as name:
        port = SerialPort(name)
        with pytest.raises(DeviceLost) as caught:
            StepRampController(port).connect()
        port.close()
        assert str(caught.value) == message.format(port=name)
