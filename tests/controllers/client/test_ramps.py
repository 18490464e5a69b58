"""Ramps and settings that the client stores, tries, keeps and takes back."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from controllers.client.script import BYTES, HELLO, IDLE, NO_RAMP, Connect, Script, stored
from controllers.ramps import four_axes
from designs import design
from stepramp.controllers.stepramp import transfer
from stepramp.controllers.stepramp.controller import StepRampController
from stepramp.controllers.stepramp.frames import crc16
from stepramp.controllers.stepramp.messages.body import DoneReply
from stepramp.controllers.stepramp.messages.ramps import (
    BeginRequest,
    CommitRequest,
    DataReply,
    DataRequest,
    EndRequest,
    ReadReply,
    ReadRequest,
    RollBackRequest,
    TryRequest,
)
from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus
from stepramp.controllers.stepramp.messages.settings import ReadSettingsRequest, SettingsReply, WriteSettingsRequest
from stepramp.controllers.stepramp.messages.status import StatusReply, StatusRequest
from stepramp.controllers.stepramp.push import plan_push
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.errors import Refused
from stepramp.link.serial_port import SerialPort


def test_storing_an_image(connect: Connect) -> None:
    writing = StatusReply(3, 0, 0, 0, 0, 0, 1, 1, 0, 0)
    script = Script().delivers(BYTES).then(CommitRequest(), DoneReply()).then(StatusRequest(0), writing)
    script.then(StatusRequest(0), StatusReply(0, 0, 0, 0, 0, 0, 9, 1, 0, 0)).reads(0, BYTES)
    assert connect(script).store(BYTES) == (BYTES, 9)


def test_trying_an_image(connect: Connect) -> None:
    script = stored().delivers(BYTES).then(TryRequest(), DoneReply()).then(StatusRequest(0), IDLE).reads(1, BYTES)
    assert connect(script).try_out(BYTES) == (BYTES, 1)


def test_what_the_ram_holds_is_compared_before_it_is_used(connect: Connect) -> None:
    controller = connect(Script().delivers(BYTES, staged=bytes(len(BYTES))))
    with pytest.raises(Refused, match="another ramp than the one sent"):
        controller.store(BYTES)


def test_a_memory_that_fails(connect: Connect) -> None:
    script = Script().delivers(BYTES).then(CommitRequest(), DoneReply())
    script.then(StatusRequest(0), StatusReply(0, 0, 0, 0, 0, 0, 1, 1, 1, 0))
    with pytest.raises(Refused, match="could not store"):
        connect(script).store(BYTES)


def test_a_memory_that_never_gets_done(connect: Connect, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(transfer, "WRITE_TIMEOUT_S", 0.0)
    script = Script().delivers(BYTES).then(CommitRequest(), DoneReply())
    script.then(StatusRequest(0), StatusReply(3, 0, 0, 0, 0, 0, 1, 1, 0, 0))
    with pytest.raises(Refused, match="without an end"):
        connect(script).store(BYTES)


@pytest.mark.parametrize(
    ("refusal", "words"),
    [
        (Refusal(ReplyStatus.BAD_CRC, 0x1234), "arrived damaged"),
        (Refusal(ReplyStatus.BAD_RAMP, 0x0211), "refuses segment 17 of ramp 2"),
        (Refusal(ReplyStatus.BAD_RAMP, 0x02FF), "refuses the header of ramp 2"),
        (Refusal(ReplyStatus.BAD_RAMP, 0xFFFF), "refuses the ramps' header"),
        (Refusal(ReplyStatus.OUT_OF_ORDER, 48), r"out_of_order \(48\)"),
    ],
)
def test_an_image_that_is_refused(connect: Connect, refusal: Refusal, words: str) -> None:
    script = Script().then(BeginRequest(1, crc16(b"x")), DoneReply()).then(DataRequest(0, b"x"), DataReply(1))
    script.then(EndRequest(), refusal)
    with pytest.raises(Refused, match=words):
        connect(script).store(b"x")


def test_a_push_is_refused_while_moving(connect: Connect) -> None:
    image = plan_push([design()], HELLO, StepRampSettings()).image.encode()
    controller = connect(Script().then(BeginRequest(len(image), crc16(image)), Refusal(ReplyStatus.MOVING)))
    with pytest.raises(Refused, match="moves"):
        controller.prepare_push([design()])()


def test_a_push_to_one_axis_does_not_undo_another(connect: Connect) -> None:
    plan = plan_push([design()], HELLO, StepRampSettings(), 0)
    image = plan.image.encode()
    script = Script().delivers(image).then(TryRequest(), DoneReply()).then(StatusRequest(0), NO_RAMP).reads(1, image)
    controller = connect(script)
    first, second = (controller.prepare_push([design()], 0, "try") for _ in range(2))
    assert not first().kept
    with pytest.raises(Refused, match="changed in the meantime"):
        second()


def test_keeping(connect: Connect) -> None:
    script = stored().then(CommitRequest(), DoneReply()).then(StatusRequest(0), IDLE).reads(0, BYTES)
    connect(script).keep()
    with pytest.raises(Refused, match="push a design first"):
        connect(Script()).keep()


def test_rolling_back(connect: Connect) -> None:
    on_trial = StatusReply(0, 0, 0, 0, 0, 0, 1, 7, 2, 0)
    script = stored().then(StatusRequest(0), on_trial).then(RollBackRequest(), DoneReply())
    script.then(StatusRequest(0), IDLE).then(ReadSettingsRequest(), SettingsReply(StepRampSettings().pack())).reads(
        0, BYTES
    )
    controller = connect(script.then(StatusRequest(0), IDLE))
    controller.roll_back()
    with pytest.raises(Refused, match="Nothing is on trial"):
        controller.roll_back()


def test_restoring(connect: Connect) -> None:
    previous, restored = four_axes().encode(), StatusReply(0, 0, 0, 0, 0, 0, 2, 7, 0, 0)
    settings = SettingsReply(StepRampSettings(pulse_width_us=4).pack())
    script = stored().then(StatusRequest(0), IDLE).reads(2, previous).then(RollBackRequest(), DoneReply())
    script.then(StatusRequest(0), restored).then(ReadSettingsRequest(), settings).reads(0, previous)
    connect(script.then(StatusRequest(0), restored)).restore()


def test_restoring_what_is_not_there_or_while_something_is_on_trial(connect: Connect) -> None:
    script = stored().then(StatusRequest(0), IDLE).reads(2, b"")
    with pytest.raises(Refused, match="no ramps that were stored before"):
        connect(script).restore()
    on_trial = StatusReply(0, 0, 0, 0, 0, 0, 1, 7, 2, 0)
    with pytest.raises(Refused, match="roll them back first"):
        connect(stored().then(StatusRequest(0), on_trial)).restore()


def test_restoring_when_an_image_was_delivered_and_not_used(connect: Connect) -> None:
    """The first roll back then only drops that one."""
    settings, restored = SettingsReply(StepRampSettings().pack()), StatusReply(0, 0, 0, 0, 0, 0, 2, 7, 0, 0)
    script = stored().then(StatusRequest(0), IDLE).reads(2, BYTES).then(RollBackRequest(), DoneReply())
    script.then(StatusRequest(0), IDLE).then(ReadSettingsRequest(), settings).reads(0, BYTES)
    script.then(StatusRequest(0), IDLE).then(RollBackRequest(), DoneReply())
    script.then(StatusRequest(0), restored).then(ReadSettingsRequest(), settings).reads(0, BYTES)
    connect(script).restore()


def test_settings(connect: Connect) -> None:
    other = StepRampSettings(pulse_width_us=9)
    script = Script(settings=other).then(ReadSettingsRequest(), SettingsReply(other.pack()))
    controller = connect(script.then(WriteSettingsRequest(StepRampSettings().pack()), DoneReply()))
    assert controller.settings() == other
    controller.use_settings(StepRampSettings())


def test_it_gives_way_before_each_request_and_while_the_memory_is_written(plug_in: Callable) -> None:
    gaps: list[float] = []
    script = Script().delivers(BYTES).then(CommitRequest(), DoneReply())
    script.then(StatusRequest(0), StatusReply(3, 0, 0, 0, 0, 0, 1, 1, 0, 0))
    script.then(StatusRequest(0), IDLE).then(ReadRequest(0, 0, 48), ReadReply(0, b""))
    port = SerialPort(plug_in(script))
    controller = StepRampController(port, gaps.append)
    controller.connect()
    assert controller.store(BYTES) == (b"", 1)
    requests = 1 + 2 + 3 + 2 * -(-len(BYTES) // 48)
    assert gaps == [0.0] * (requests + 1) + [transfer.WRITE_POLL_S] + [0.0] * 2
    port.close()
