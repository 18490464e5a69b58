"""What the client hears without asking."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from controllers.client.script import IDLE, SESSION, Connect, replied, said, stored
from stepramp.controllers.contract import Activity, AxisCommand, ControllerStatus
from stepramp.controllers.stepramp.controller import StepRampController
from stepramp.controllers.stepramp.frames import encode_frame
from stepramp.controllers.stepramp.messages.body import DoneReply, Reply, Request
from stepramp.controllers.stepramp.messages.message import Message
from stepramp.controllers.stepramp.messages.motion import (
    LineRequest,
    MoveByRequest,
    RunRequest,
    TargetsReply,
    ZeroRequest,
)
from stepramp.controllers.stepramp.messages.report import ReportNotice
from stepramp.controllers.stepramp.messages.status import StatusReply, StatusRequest
from stepramp.controllers.stepramp.messages.trace import TraceNotice


def test_reports_are_heard_without_asking(connect: Connect) -> None:
    moving = StatusReply(1, 1, 10, 2000, 4000, 10, 1, 7, 0, 0)
    script = stored().then(StatusRequest(0), moving)
    controller = connect(script)
    assert controller.listen() is None
    controller.status()
    script.unasked = said(ReportNotice(1, 1, ((20, 2000),))) + said(ReportNotice(21, 1, ((40, 1000),)), 1)
    heard = controller.listen()
    assert heard is not None
    [axis] = heard.axes
    assert (axis.position_steps, axis.target_steps, axis.speed_steps_per_s) == (40, 2000, 2000.0)
    assert (axis.steps_made, heard.activity) == (40, Activity.MOVING)
    assert controller.listen() is None


TO_TARGETS: list[tuple[Callable[[StepRampController], None], Request, Reply]] = [
    (
        lambda controller: controller.move_by([AxisCommand(0, 1500, "by_steps")]),
        MoveByRequest(1, (1500,)),
        TargetsReply((1500,)),
    ),
    (
        lambda controller: controller.line([AxisCommand(0, 1500, "by_steps")]),
        LineRequest(1, 0, (1500,)),
        TargetsReply((1500,)),
    ),
    (lambda controller: controller.zero([0], 1500), ZeroRequest(1, 1500), DoneReply()),
]


@pytest.mark.parametrize("rests", [False, True], ids=["in flight", "after it ended"])
@pytest.mark.parametrize(("to_target", "request_", "reply"), TO_TARGETS, ids=["move", "line", "zero"])
def test_after_a_run_a_target_is_told_again(
    connect: Connect, to_target: Callable, request_: Request, reply: Reply, rests: bool
) -> None:
    """An axis that runs has no target but where it is; what it is asked next has one."""
    running, moving = StatusReply(1, 1, 10, 10, 4000, 10, 1, 7, 0, 0), StatusReply(1, 1, 10, 1500, 4000, 10, 1, 7, 0, 0)
    script = stored().then(StatusRequest(0), IDLE).then(RunRequest(1, (4000,)), DoneReply())
    script.then(StatusRequest(0), running)
    if rests:
        script.then(StatusRequest(0), IDLE)
    script.then(request_, reply).then(StatusRequest(0), moving)
    controller = connect(script)
    controller.status()
    controller.run([AxisCommand(0, 500.0, "speed_steps_per_s")])
    controller.status()
    if rests:
        controller.status()
    to_target(controller)
    controller.status()
    script.unasked = said(ReportNotice(1, 1, ((20, 4000),)))
    [axis] = heard_of(controller).axes
    assert (axis.position_steps, axis.target_steps) == (20, 1500)


def heard_of(controller: StepRampController) -> ControllerStatus:
    heard = controller.listen()
    assert heard is not None
    return heard


def test_steps_of_a_run_are_counted_past_the_last_position(connect: Connect) -> None:
    moving = StatusReply(1, 1, 2**31 - 5, 2**31 - 5, 4000, 10, 1, 7, 0, 0)
    script = stored().then(StatusRequest(0), moving)
    controller = connect(script)
    controller.status()
    script.unasked = said(ReportNotice(1, 1, ((-(2**31) + 15, 2000),)))
    heard = controller.listen()
    assert heard is not None
    assert (heard.axes[0].position_steps, heard.axes[0].steps_made) == (-(2**31) + 15, 30)


def test_a_report_of_another_state_is_reason_to_ask(connect: Connect) -> None:
    moving = StatusReply(1, 1, 10, 2000, 4000, 10, 1, 7, 0, 0)
    script = stored().then(StatusRequest(0), moving).then(StatusRequest(0), IDLE)
    controller = connect(script)
    controller.status()
    script.unasked = said(ReportNotice(1, 0, ((0, 0),)))
    heard = controller.listen()
    assert heard is not None
    assert heard.activity is Activity.READY


def test_what_is_unasked_is_never_taken_for_a_reply(connect: Connect) -> None:
    script = stored()
    tag = script.tag + 1
    report, trace = ReportNotice(0, 0, ((77, 0),)), TraceNotice(0, 1, 1, (5,))
    noise = said(report, tag) + said(trace, tag) + encode_frame(Message(0xC7, SESSION, tag, b"\0").pack())
    script.then(StatusRequest(0), noise + replied(StatusRequest(0), IDLE, tag) + said(report, tag + 1))
    controller = connect(script)
    assert controller.status().axes[0].position_steps == 0
    heard = controller.listen()
    assert heard is not None
    assert heard.axes[0].position_steps == 77


def test_notices_of_another_session_or_without_sense_are_dropped(connect: Connect) -> None:
    script = stored().then(StatusRequest(0), IDLE)
    controller = connect(script)
    controller.status()
    odd = encode_frame(Message(0xC0, SESSION, 1, b"\1").pack())
    script.unasked = said(ReportNotice(0, 1, ((5, 9),)), session=SESSION + 1) + odd
    assert controller.listen() is None
