"""The client's handshake, and what it knows of the controller afterwards."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest

from controllers.client.script import BYTES, HELLO, IDLE, NO_RAMP, SESSION, Connect, Script, replied, said, stored
from controllers.ramps import four_axes
from stepramp.controllers.capabilities import HasInputs
from stepramp.controllers.contract import Activity, StoredRamp
from stepramp.controllers.stepramp import conversation
from stepramp.controllers.stepramp.controller import StepRampController
from stepramp.controllers.stepramp.frames import FrameSplitter, encode_frame
from stepramp.controllers.stepramp.messages.body import DoneReply, Reply
from stepramp.controllers.stepramp.messages.message import Message
from stepramp.controllers.stepramp.messages.motion import AcknowledgeRequest
from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus, pack_reply
from stepramp.controllers.stepramp.messages.report import ReportNotice, ReportRequest
from stepramp.controllers.stepramp.messages.session import HelloReply, HelloRequest
from stepramp.controllers.stepramp.messages.settings import (
    ReadSettingsRequest,
    SettingsReply,
    WriteSettingsRequest,
)
from stepramp.controllers.stepramp.messages.status import StatusReply, StatusRequest
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.errors import DeviceLost, Refused, Rejected
from stepramp.link.serial_port import SerialPort


def test_before_the_handshake_nothing_is_known(plug_in: Callable) -> None:
    port = SerialPort(plug_in(Script()))
    with pytest.raises(DeviceLost, match="not connected"):
        _ = StepRampController(port).timer_hz
    port.close()


def test_the_handshake(connect: Connect) -> None:
    controller = connect(Script())
    assert (controller.timer_hz, controller.firmware_version) == (2_000_000, "0.2.0")
    assert controller.clocks_hz == (16_000_000, 2_000_000)
    assert controller.identity == HELLO


def test_the_ramps_that_are_there_are_read(connect: Connect) -> None:
    script = stored(four_axes().encode())
    for axis in range(4):
        script.then(StatusRequest(axis), IDLE)
    assert len(connect(script).status().axes) == 4


def test_ramps_on_trial_are_read_from_ram(connect: Connect) -> None:
    known = HelloReply(**{**vars(HELLO), "ramp_in_use": 2})
    script = Script(known, image=BYTES)
    for number in range(2, 2 - (-len(BYTES) // 48)):
        message, answer = script.pairs[number]
        script.pairs[number] = (Message(message.kind, SESSION, message.tag, b"\1" + message.body[1:]), answer)
    connect(script)


def test_ramps_without_sense(connect: Connect) -> None:
    script = stored(b"\xff" * 20)
    script.pairs.pop()
    with pytest.raises(DeviceLost, match="without sense"):
        connect(script)


def test_hello_is_repeated_until_the_board_has_started(connect: Connect) -> None:
    script = Script()
    hello, good = script.pairs[0]
    garbage = b"\xf0Booting\r\n" + bytes(3)
    late = replied(HelloRequest(), HELLO, 0, session=SESSION + 1)
    before = [(hello, b""), (hello, garbage), (hello, late), (hello, good[:5]), (hello, b"\0" + good)]
    script.pairs[:1] = before
    assert connect(script).identity == HELLO


class Chattering(Script):
    """Tells an earlier client what it does until it hears a hello."""

    def exchange(self, data: bytes) -> bytes:
        self.unasked = said(ReportNotice(0, 0, ((5, 0),)), session=7) if len(self.pairs) == 3 else b""
        return super().exchange(data)


def test_a_controller_that_still_reports_to_an_earlier_client(
    connect: Connect, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(conversation, "GARBAGE_S", 0.01)
    monkeypatch.setattr(conversation, "MOST_GARBAGE_S", 0.05)
    assert connect(Chattering()).listen() is None


def test_nothing_answers(connect: Connect) -> None:
    script = Script()
    hello, _ = script.pairs[0]
    script.pairs = [(hello, b"")] * 1000
    with pytest.raises(DeviceLost, match="Nothing answers at"):
        connect(script)
    assert 5 <= 1000 - len(script.pairs) <= 21
    script.pairs.clear()


def test_another_version_of_the_protocol(connect: Connect) -> None:
    script = Script()
    for version in (1, 4):
        script.pairs = [(script.pairs[0][0], replied(HelloRequest(), Refusal(ReplyStatus.BAD_VERSION, version), 0))]
        with pytest.raises(Refused, match=f"speaks version {version} of the protocol, this program version 3"):
            connect(script)
        script = Script()
    script.pairs = []


def test_a_clock_of_0_hz_makes_no_sense(connect: Connect) -> None:
    script = Script()
    body = bytearray(pack_reply(HELLO))
    body[5:9] = bytes(4)
    script.pairs = [(script.pairs[0][0], encode_frame(Message(0x81, SESSION, 0, bytes(body)).pack()))]
    with pytest.raises(DeviceLost, match="0 Hz"):
        connect(script)


def test_letting_go_ends_the_reports(connect: Connect) -> None:
    connect(Script().then(ReportRequest(0), DoneReply())).disconnect()


def test_what_a_status_means(connect: Connect) -> None:
    moving = StatusReply(1, 1, -120, 2000, 4000, 120, 3, 0x1234, 6, 2)
    stopping = StatusReply(1, 2, 5, 9, 8000, 5, 3, 0x1234, 0, 0)
    script = stored().then(StatusRequest(0), moving).then(StatusRequest(0), stopping)
    controller = connect(script.then(StatusRequest(0), StatusReply(3, 0, 5, 5, 0, 5, 1, 7, 0, 0)))
    status = controller.status()
    [axis] = status.axes
    assert (status.activity, axis.position_steps, axis.target_steps) == (Activity.MOVING, -120, 2000)
    assert (axis.speed_steps_per_s, axis.steps_made, status.ramp) == (500.0, 120, StoredRamp(3, 0x1234))
    assert (status.on_trial, status.motors_on, status.starved) == (True, True, 2)
    assert controller.status().activity is Activity.STOPPING
    assert controller.status().activity is Activity.WRITING


def test_without_a_ramp_there_is_still_one_axis(connect: Connect) -> None:
    status = connect(Script().then(StatusRequest(0), NO_RAMP)).status()
    assert (len(status.axes), status.ramp, status.activity) == (1, None, Activity.READY)


class Recorded:
    """A controller of version 2, as it answered once: frames by frames, and nothing to any other."""

    def __init__(self, answers: dict[bytes, Reply | Refusal]) -> None:
        self.answers = answers
        self.asked: list[bytes] = []

    def opened(self) -> None:
        pass

    def exchange(self, data: bytes) -> bytes:
        answer = b""
        for frame in filter(None, data.split(b"\0")):
            self.asked.append(frame)
            message = Message.unpack(next(iter(FrameSplitter().feed(frame + b"\0"))))
            assert message is not None
            body = pack_reply(self.answers[message.pack()])
            answer += encode_frame(Message(message.kind | 0x80, message.session, message.tag, body).pack())
        return answer


def test_with_a_controller_of_version_2_its_version_is_spoken(plug_in: Callable) -> None:
    second = HelloReply(**{**vars(HELLO), "protocol_version": 2, "more": b""})
    assert len(pack_reply(second)) == 1 + 44
    board = Recorded(
        {
            bytes.fromhex("01 3412 00 03"): Refusal(ReplyStatus.BAD_VERSION, 2),
            bytes.fromhex("01 3412 01 02"): second,
            bytes.fromhex("17 3412 02"): SettingsReply(bytes.fromhex("0000000000001e000100ffff")),
            bytes.fromhex("03 3412 03 32"): DoneReply(),
            bytes.fromhex("02 3412 04 00"): NO_RAMP,
            bytes.fromhex("18 3412 05 0000000000091e000100ffff"): DoneReply(),
        }
    )
    port = SerialPort(plug_in(board))
    controller = StepRampController(port)
    controller.connect()
    assert controller.lacks == (HasInputs,)
    status = controller.status()
    assert (status.of_inputs, status.axes[0].position_known, status.axes[0].homing) == (None, None, None)
    with pytest.raises(Rejected, match=r"looks is 3; allowed: null: the controller at sim://.* has no inputs"):
        controller.use_settings(StepRampSettings(looks=3))
    controller.use_settings(StepRampSettings(pulse_width_us=9))
    port.close()


def test_settings_of_inputs_are_written_over_those_in_use_with_what_isnt_known(connect: Connect) -> None:
    in_use = bytes.fromhex("0000000000001e000100ffff 06010a 018200000000000000 abcd")
    script = Script()
    script.pairs[1] = (script.pairs[1][0], replied(ReadSettingsRequest(), SettingsReply(in_use), 1))
    changed = bytes.fromhex("0000000000091e000100ffff 06010a 010000000000000000 abcd")
    script.then(WriteSettingsRequest(bytes.fromhex("0000000000091e000100ffff")), DoneReply())
    script.then(WriteSettingsRequest(changed), DoneReply())
    controller = connect(script)
    controller.use_settings(StepRampSettings(pulse_width_us=9))
    stop = {"input": "A0", "role": "emergency_stop"}
    controller.use_settings(StepRampSettings.checked({"pulse_width_us": 9, "inputs": [stop]}))


def test_refusals_name_input_and_axis(connect: Connect) -> None:
    in_use = bytes.fromhex("0000000000001e000100ffff 04000a 0182000000000000 0d")
    script = stored()
    script.pairs[1] = (script.pairs[1][0], replied(ReadSettingsRequest(), SettingsReply(in_use), 1))
    refusals = {
        Refusal(ReplyStatus.STOPPED, 0b1_0000_0001): "the emergency stop at A0 is active. First release it, then ack",
        Refusal(ReplyStatus.STOPPED, 0b11): "the emergency stop at A0 and the driver's fault at A1 are active. First",
        Refusal(ReplyStatus.AT_LIMIT, 0x0801): "Axis 1 is on the limit switch of its high end at D11 and goes no",
        Refusal(ReplyStatus.AT_LIMIT, 0x0903): "Axis 3 is on a limit switch and goes no further that way: move it the",
    }
    for refusal in refusals:
        script.then(AcknowledgeRequest(), refusal)
    controller = connect(script)
    for words in refusals.values():
        with pytest.raises(Refused, match=re.escape(words)):
            controller.acknowledge()
