"""Replies that are lost, garbled, stale or without sense."""

from __future__ import annotations

import pytest

from controllers.client.script import BYTES, IDLE, SESSION, Connect, Script, by_steps, replied, stored
from stepramp.controllers.contract import StoredRamp
from stepramp.controllers.stepramp.frames import crc16, encode_frame
from stepramp.controllers.stepramp.messages.body import DoneReply
from stepramp.controllers.stepramp.messages.message import Message
from stepramp.controllers.stepramp.messages.motion import MoveByRequest, StopRequest, TargetsReply
from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus
from stepramp.controllers.stepramp.messages.status import StatusReply, StatusRequest
from stepramp.errors import DeviceLost

NOISE = bytes([7, 1, 99])


def test_a_lost_reply_is_asked_for_again_with_the_same_tag(connect: Connect) -> None:
    script = stored().then(StatusRequest(0), IDLE)
    script.then(MoveByRequest(1, (5,)), b"").then(MoveByRequest(1, (5,)), b"", again=True)
    script.then(MoveByRequest(1, (5,)), TargetsReply((5,)), again=True).then(StopRequest(), DoneReply())
    controller = connect(script)
    controller.move_by(by_steps(5))
    controller.stop()


def test_a_repeat_ends_the_noise_before_it(connect: Connect) -> None:
    script = stored().then(StatusRequest(0), IDLE).then(StatusRequest(0), IDLE)
    controller = connect(script)
    script.noise = NOISE
    assert controller.status() == controller.status()


def test_a_garbled_reply_counts_as_lost(connect: Connect) -> None:
    script = stored()
    good = replied(StatusRequest(0), IDLE, script.tag + 1)
    garbled = good[:8] + bytes([good[8] ^ 1 or 2]) + good[9:]
    script.then(StatusRequest(0), garbled).then(StatusRequest(0), good[:-3] + b"\0", again=True)
    script.then(StatusRequest(0), IDLE, again=True)
    assert connect(script).status().ramp == StoredRamp(1, crc16(BYTES))


def test_a_stale_reply_is_no_answer(connect: Connect) -> None:
    script = stored()
    tag = script.tag + 1
    other = StatusReply(0, 0, 99, 99, 0, 0, 0, 0, 0, 0)
    stale = replied(StatusRequest(0), other, tag - 1) + replied(StatusRequest(0), other, tag, session=SESSION + 1)
    script.then(StatusRequest(0), stale + replied(StatusRequest(0), IDLE, tag))
    assert connect(script).status().axes[0].position_steps == 0


def test_no_answer_after_three_repeats(connect: Connect) -> None:
    script = stored().then(StatusRequest(0), b"")
    for _ in range(3):
        script.then(StatusRequest(0), b"", again=True)
    with pytest.raises(DeviceLost, match="does not answer"):
        connect(script).status()


def test_a_controller_that_was_restarted_is_lost(connect: Connect) -> None:
    script = stored().then(StatusRequest(0), Refusal(ReplyStatus.STALE_SESSION))
    with pytest.raises(DeviceLost, match="was restarted"):
        connect(script).status()


@pytest.mark.parametrize("body", [b"", b"\x63\0\0", b"\0", b"\4\0", b"\0\x09" + bytes(26), b"\0\0\x03" + bytes(25)])
def test_answers_without_sense(connect: Connect, body: bytes) -> None:
    script = stored()
    script.then(StatusRequest(0), encode_frame(Message(0x82, SESSION, script.tag + 1, body).pack()))
    with pytest.raises(DeviceLost, match="without sense"):
        connect(script).status()


def test_tags_begin_again_after_255(connect: Connect) -> None:
    script = Script()
    for _ in range(300):
        script.then(StopRequest(), DoneReply())
    controller = connect(script)
    for _ in range(300):
        controller.stop()
