"""Traces that the client collects."""

from __future__ import annotations

from dataclasses import replace

import pytest

from controllers.client.script import IDLE, Connect, said, stored
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.stepramp.messages.body import DoneReply
from stepramp.controllers.stepramp.messages.motion import MoveByRequest, RunRequest, StopRequest, TargetsReply
from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus
from stepramp.controllers.stepramp.messages.status import AxisState, StatusRequest
from stepramp.controllers.stepramp.messages.trace import TraceNotice, TraceReply, TraceRequest
from stepramp.errors import Refused, Rejected


def test_a_trace_is_collected_with_the_plan_of_the_move(connect: Connect) -> None:
    script = stored().then(TraceRequest(0, 2), TraceReply(2))
    script.then(StatusRequest(0), IDLE).then(StatusRequest(0), IDLE)
    script.then(MoveByRequest(1, (-5,)), TargetsReply((-5,)))
    controller = connect(script)
    assert controller.trace is None
    assert controller.trace_moves(0, 2).every_steps == 2
    controller.move_by([AxisCommand(0, -5, "by_steps")])
    # The slowest five of 4000, 2828 … up and 4000, 3900 … down: 4000 up, then 3700, 3800, 3900, 4000 down.
    script.unasked = said(TraceNotice(0, 2, 1, (60_000, (60_000 + 7700) % 65_536))) + said(
        TraceNotice(0x80, 2, 5, ((60_000 + 15_400 + 4) % 65_536,)), 1
    )
    controller.listen()
    assert controller.trace is not None
    trace = controller.trace()
    assert (trace.complete, trace.step.tolist()) == (True, [1, 3, 5])
    assert trace.planned_ticks.tolist() == [0, 7700, 15_400]
    assert trace.deviation_us.tolist() == [0.0, 0.0, 2.0]


def test_a_stop_ends_the_trace(connect: Connect) -> None:
    script = stored().then(TraceRequest(0, 0), TraceReply(1))
    script.then(StatusRequest(0), IDLE).then(StatusRequest(0), IDLE)
    script.then(RunRequest(1, (2000,)), DoneReply()).then(StopRequest(), DoneReply())
    controller = connect(script)
    controller.trace_moves(0, 0)
    controller.run([AxisCommand(0, 1000.0, "speed_steps_per_s")])
    script.unasked = said(TraceNotice(0, 1, 1, (1, 4001)))
    controller.listen()
    controller.stop()
    script.unasked = said(TraceNotice(0x80, 1, 3, (9, 9)))
    controller.listen()
    assert controller.trace is not None
    trace = controller.trace()
    assert (trace.changed, trace.complete, trace.step.tolist()) == (True, True, [1, 2])


def test_no_trace_of_an_axis_that_is_not_there(connect: Connect) -> None:
    with pytest.raises(Rejected) as caught:
        connect(stored()).trace_moves(2, 0)
    assert caught.value.rejections[0].field == "traced_axis"


def test_the_last_trace_is_kept_until_another_move_is_taken(connect: Connect) -> None:
    script = stored().then(TraceRequest(0, 0), TraceReply(1))
    script.then(StatusRequest(0), IDLE).then(StatusRequest(0), IDLE)
    script.then(MoveByRequest(1, (-2,)), TargetsReply((-2,)))
    script.then(TraceRequest(0, 0), TraceReply(1)).then(StatusRequest(0), IDLE)
    script.then(MoveByRequest(1, (9,)), Refusal(ReplyStatus.WRITING, 0))
    script.then(StatusRequest(0), IDLE).then(MoveByRequest(1, (3,)), TargetsReply((3,)))
    controller = connect(script)
    controller.trace_moves(0, 0)
    controller.move_by([AxisCommand(0, -2, "by_steps")])
    script.unasked = said(TraceNotice(0, 1, 1, (7, 4007)))
    controller.listen()
    controller.trace_moves(0, 0)
    with pytest.raises(Refused):
        controller.move_by([AxisCommand(0, 9, "by_steps")])
    assert controller.trace is not None
    assert controller.trace().step.tolist() == [1, 2]
    controller.move_by([AxisCommand(0, 3, "by_steps")])
    assert controller.trace().step.tolist() == []
    script.unasked = said(TraceNotice(0x80, 1, 1, (5, 4005, 8005)))
    controller.listen()
    assert controller.trace().step.tolist() == [1, 2, 3]


def test_a_move_that_is_not_traced_has_not_the_trace_of_the_last_one(connect: Connect) -> None:
    moving = replace(IDLE, axis_state=AxisState.MOVING)
    script = stored().then(TraceRequest(0, 0), TraceReply(1))
    script.then(StatusRequest(0), IDLE).then(StatusRequest(0), IDLE)
    script.then(MoveByRequest(1, (-2,)), TargetsReply((-2,)))
    script.then(TraceRequest(0, 0), TraceReply(1)).then(StatusRequest(0), moving)
    script.then(MoveByRequest(1, (9,)), TargetsReply((9,)))
    controller = connect(script)
    for steps, number in ((-2, 1), (9, 2)):
        assert controller.trace_moves(0, 0).number == number, "also what is not traced counts"
        controller.move_by([AxisCommand(0, steps, "by_steps")])
    assert controller.trace is None


def test_each_motion_has_its_own_number(connect: Connect) -> None:
    """So that a motion after the one that was to be traced is not taken for it."""
    script = stored().then(TraceRequest(0, 0), TraceReply(1)).then(StatusRequest(0), IDLE)
    for steps in (-2, 9):
        script.then(StatusRequest(0), IDLE).then(MoveByRequest(1, (steps,)), TargetsReply((steps,)))
    controller = connect(script)
    assert controller.trace_moves(0, 0).number == 1
    for steps, number in ((-2, 1), (9, 2)):
        controller.move_by([AxisCommand(0, steps, "by_steps")])
        script.unasked = said(TraceNotice(0x80, 1, 1, (7,)))
        controller.listen()
        assert controller.trace is not None
        assert controller.trace().number == number
