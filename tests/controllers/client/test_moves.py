"""Motions that the client asks for, and those that it rejects."""

from __future__ import annotations

import pytest

from controllers.client.script import IDLE, Connect, Script, by_steps, four, stored
from controllers.ramps import four_axes
from designs import design
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.stepramp.controller import StepRampController
from stepramp.controllers.stepramp.messages.body import DoneReply
from stepramp.controllers.stepramp.messages.motion import (
    HaltRequest,
    LineRequest,
    MoveByRequest,
    MoveToRequest,
    RunRequest,
    SetPositionRequest,
    StopRequest,
    TargetsReply,
    ZeroRequest,
)
from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus
from stepramp.controllers.stepramp.messages.status import StatusRequest
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.errors import Refused, Rejected


@pytest.mark.parametrize(
    ("status", "words"),
    [
        (ReplyStatus.MOVING, "The motor moves"),
        (ReplyStatus.NO_RAMP, "has no ramp"),
        (ReplyStatus.WRITING, "storing a ramp"),
        (ReplyStatus.UNKNOWN_KIND, "unknown_kind"),
    ],
)
def test_refusals_in_words(connect: Connect, status: ReplyStatus, words: str) -> None:
    script = stored().then(StatusRequest(0), IDLE).then(MoveToRequest(1, (5,)), Refusal(status, 1))
    with pytest.raises(Refused, match=words):
        connect(script).move_to([AxisCommand(0, 5, "to_steps")])


def test_several_axes_in_one_request(connect: Connect) -> None:
    script = four().then(MoveByRequest(0b1001, (7, -3)), TargetsReply((7, -3)))
    script.then(MoveToRequest(0b0110, (-5, 6)), TargetsReply((-5, 6)))
    script.then(RunRequest(0b0011, (2000, -4000)), DoneReply())
    script.then(LineRequest(0b0101, 0, (30, -10)), TargetsReply((30, -10)))
    script.then(LineRequest(0b0011, 1, (30, -10)), TargetsReply((30, -10)))
    script.then(SetPositionRequest(0b1000, (-9,)), DoneReply()).then(ZeroRequest(0b0010, 300), DoneReply())
    script.then(StopRequest(b"\x06"), DoneReply()).then(HaltRequest(), DoneReply())
    controller = connect(script)
    controller.move_by([AxisCommand(3, -3, "axes.0.by_steps"), AxisCommand(0, 7, "axes.1.by_steps")])
    controller.move_to([AxisCommand(1, -5, "axes.0.to_steps"), AxisCommand(2, 6, "axes.1.to_steps")])
    controller.run([AxisCommand(0, 1000.0, "a"), AxisCommand(1, -500.0, "b")])
    controller.line([AxisCommand(0, 30, "axes.0.by_steps"), AxisCommand(2, -10, "axes.1.by_steps")])
    controller.line(by_steps(30, -10), ramp_axis=1)
    controller.set_position([AxisCommand(3, -9, "axes.0.position_steps")])
    controller.zero([1], 300)
    controller.stop([1, 2])
    controller.halt()


def test_a_line_plays_the_ramp_of_the_slowest_axis(connect: Connect) -> None:
    # Axes 0 and 2 have a slew interval of 1,000 ticks, 1 and 3 of 900.
    script = stored(four_axes().encode()).then(LineRequest(0b0110, 2, (30, -10)), TargetsReply((30, -10)))
    connect(script).line([AxisCommand(1, 30, "axes.0.by_steps"), AxisCommand(2, -10, "axes.1.by_steps")])


def test_without_a_ramp_nothing_is_asked(connect: Connect) -> None:
    controller = connect(Script())
    for move in (
        lambda: controller.move_by(by_steps(1)),
        lambda: controller.run([AxisCommand(0, 5.0, "speed_steps_per_s")]),
        lambda: controller.zero([0], 5),
    ):
        with pytest.raises(Refused, match="no ramp yet"):
            move()


@pytest.mark.parametrize(
    ("asked", "field"),
    [
        ([AxisCommand(1, 5, "axes.0.by_steps")], "axes.0.axis"),
        ([AxisCommand(0, 5, "axes.0.by_steps"), AxisCommand(0, 5, "axes.1.by_steps")], "axes.1.axis"),
        ([AxisCommand(0, 2**31, "by_steps")], "by_steps"),
        # What there and back, and a jog, say of their one axis.
        ([AxisCommand(3, 5, "by_steps")], "axis"),
    ],
)
def test_what_is_rejected_before_it_is_sent(connect: Connect, asked: list[AxisCommand], field: str) -> None:
    with pytest.raises(Rejected) as caught:
        connect(stored()).move_by(asked)
    assert [each.field for each in caught.value.rejections] == [field]


def test_an_axis_that_cant_be_zeroed_is_named(connect: Connect) -> None:
    script = four().then(ZeroRequest(0b0010, 500), Refusal(ReplyStatus.TOO_FAST, 130))
    controller = connect(script)
    for axes in ([5], [1]):
        with pytest.raises(Rejected) as caught:
            controller.zero(axes, 500)
        [rejection] = caught.value.rejections
        assert (rejection.field, rejection.value) == ("axes", axes[0])


def test_the_axis_whose_target_is_too_far_is_named(connect: Connect) -> None:
    script = four().then(MoveByRequest(0b0011, (1, 2**31 - 1)), Refusal(ReplyStatus.OUT_OF_RANGE, 1))
    with pytest.raises(Rejected, match="target from -2,147,483,648") as caught:
        connect(script).move_by(by_steps(1, 2**31 - 1))
    assert caught.value.rejections[0].field == "axes.1.by_steps"


@pytest.mark.parametrize("speed", [2010.0, -2100.0])
def test_speeds_that_the_ramp_does_not_lead_to(connect: Connect, speed: float) -> None:
    with pytest.raises(Rejected, match=r"from -2,000 to 2,000 steps/s, the slew speed") as caught:
        connect(stored()).run([AxisCommand(0, speed, "speed_steps_per_s")])
    assert caught.value.rejections[0].field == "speed_steps_per_s"


def test_a_speed_that_takes_longer_than_the_longest_interval(connect: Connect) -> None:
    with pytest.raises(Rejected, match=r"allowed: a number from 0.0074505\d+ to 2,000 steps/s either way, or 0"):
        connect(stored()).run([AxisCommand(0, 0.005, "speed_steps_per_s")])


def test_what_gauges_can_not_do(controller: StepRampController) -> None:
    controller.prepare_push([design()] * 4, mode="try")()
    controller.use_settings(StepRampSettings(outputs="gauges"))
    with pytest.raises(Rejected, match="a gauge: 0 to 2") as caught:
        controller.move_by(by_steps(5, 5, 5, 5))
    assert (caught.value.rejections[0].field, caught.value.rejections[0].value) == ("axes.3.axis", 3)
    with pytest.raises(Refused, match="line"):
        controller.line(by_steps(5, 5))
    controller.move_by(by_steps(5, 5, 5))
