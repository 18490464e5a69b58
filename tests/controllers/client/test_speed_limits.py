"""What is too fast for the controller, and which speed would do."""

from __future__ import annotations

import pytest

from controllers.client.script import HELLO, IDLE, Connect, by_steps, fast_image, four, stored
from designs import design
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.stepramp.controller import StepRampController
from stepramp.controllers.stepramp.messages.body import DoneReply
from stepramp.controllers.stepramp.messages.motion import MoveByRequest, RunRequest, TargetsReply
from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus
from stepramp.controllers.stepramp.messages.status import StatusReply, StatusRequest
from stepramp.controllers.stepramp.push import plan_push
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.errors import Rejected


def test_an_axis_that_ran_slowly_counts_as_it_runs_until_it_rests(connect: Connect) -> None:
    """Four axes take at least 533 fast ticks each: 457 are too fast, unless three of them run at 4,000."""
    moving, at_rest = StatusReply(1, 1, 0, 0, 4000, 5, 1, 7, 0, 0), StatusReply(0, 0, 0, 0, 0, 5, 1, 7, 0, 0)
    speeds = [AxisCommand(axis, 4000.0, f"axes.{axis}.speed_steps_per_s") for axis in (1, 2, 3)]
    script = stored(fast_image())

    def states(*replies: StatusReply) -> None:
        for axis, reply in enumerate(replies):
            script.then(StatusRequest(axis), reply)

    states(*[at_rest] * 4)
    script.then(RunRequest(0b1110, (4000,) * 3), DoneReply())
    states(at_rest, *[moving] * 3)
    script.then(MoveByRequest(1, (5,)), TargetsReply((5,)))
    states(*[at_rest] * 4)
    states(at_rest, *[moving] * 3)
    # What ran has rested since: who knows how fast it moves now?
    states(at_rest, *[moving] * 3)
    controller = connect(script)
    controller.status()
    controller.run(speeds)
    controller.status()
    controller.move_by([AxisCommand(0, 5, "by_steps")])
    for _ in range(2):
        controller.status()
    with pytest.raises(Rejected, match="this takes 117 %"):
        controller.move_by([AxisCommand(0, 5, "by_steps")])


def test_axes_that_are_too_fast_together_are_not_asked_to_move(connect: Connect) -> None:
    # Four axes take at least 533 fast ticks each, 30,018 steps/s: 35,000 are 16,000,000 / 457 of them.
    script = stored(fast_image())
    for _ in range(2):
        for axis in range(4):
            script.then(StatusRequest(axis), IDLE)
    each = ", ".join(f"axis {axis} at most 30,018 steps/s" for axis in range(4))
    told = f"{each} when they move at the same time, or fewer axes; this takes 117 %"
    with pytest.raises(Rejected, match=told) as caught:
        connect(script).move_by(by_steps(1, 1, 1, 1))
    assert (caught.value.rejections[0].field, caught.value.rejections[0].value) == ("axes", "0, 1, 2, 3")


def test_those_that_move_already_count(connect: Connect) -> None:
    moving = StatusReply(1, 1, 0, 9, 457, 5, 1, 7, 0, 0)
    script = stored(fast_image())
    for _ in range(2):
        for axis in range(4):
            script.then(StatusRequest(axis), moving if axis else IDLE)
    with pytest.raises(Rejected, match="this takes 117 %") as caught:
        connect(script).move_by([AxisCommand(0, 5, "by_steps")])
    assert caught.value.rejections[0].field == "by_steps"


@pytest.mark.parametrize("slower_steps_per_s", [100.0, 0.0])
def test_an_axis_that_is_told_to_slow_down_counts_with_the_speed_it_has(
    connect: Connect, slower_steps_per_s: float
) -> None:
    """Four at 457 ticks: one of them told to run slower, or to stop, and another one to start."""
    moving = StatusReply(1, 1, 0, 9, 457, 5, 1, 7, 0, 0)
    script = stored(fast_image())
    for _ in range(2):
        for axis in range(4):
            script.then(StatusRequest(axis), moving if axis else IDLE)
    with pytest.raises(Rejected, match="this takes 117 %"):
        connect(script).run([AxisCommand(0, 35_000.0, "axes.0"), AxisCommand(1, slower_steps_per_s, "axes.1")])


def test_an_axis_that_slows_down_counts_with_the_speed_it_has(connect: Connect) -> None:
    """It was told to run slower before, and is at 457 ticks still; once it is slow, another one may start."""
    moving, slow = (StatusReply(1, 1, 0, 9, interval, 5, 1, 7, 0, 0) for interval in (457, 4000))
    script = stored(fast_image())
    for axis in range(4):
        script.then(StatusRequest(axis), moving if axis else IDLE)
    script.then(RunRequest(2, (4000,)), DoneReply())
    for axis in range(4):
        script.then(StatusRequest(axis), moving if axis else IDLE)
    controller = connect(script)
    controller.run([AxisCommand(1, 4000.0, "speed_steps_per_s")])
    with pytest.raises(Rejected, match="this takes 117 %"):
        controller.move_by([AxisCommand(0, 5, "by_steps")])
    for axis in range(4):
        script.then(StatusRequest(axis), (slow if axis == 1 else moving) if axis else IDLE)
    script.then(MoveByRequest(1, (5,)), TargetsReply((5,)))
    controller.move_by([AxisCommand(0, 5, "by_steps")])


def test_what_only_the_controller_finds_too_fast(connect: Connect) -> None:
    script = four().then(MoveByRequest(1, (5,)), Refusal(ReplyStatus.TOO_FAST, 130))
    with pytest.raises(Rejected, match="at most 1,526 steps/s; this takes 131 %"):
        connect(script).move_by([AxisCommand(0, 5, "by_steps")])


def test_a_line_that_is_too_fast(connect: Connect) -> None:
    image = plan_push(
        [
            design(
                timer__frequency_hz=16_000_000,
                ramp__slew_speed_steps_per_s=100_000,
                ramp__acceleration_steps_per_s2=1e9,
            )
        ]
        * 4,
        HELLO,
        StepRampSettings(),
    ).image.encode()
    with pytest.raises(Rejected, match="at most 88,397 steps/s, for a line of 4 axes") as caught:
        connect(stored(image)).line(by_steps(5, 5, 5, 5))
    assert caught.value.rejections[0].field == "ramp_axis"


def quick_on(controller: StepRampController, speed_steps_per_s: float, axes: int = 1) -> None:
    """Push a ramp that is that fast, for so many axes, while pulses are short."""
    controller.use_settings(StepRampSettings())
    quick = {"ramp__slew_speed_steps_per_s": speed_steps_per_s, "ramp__acceleration_steps_per_s2": 1e9}
    controller.prepare_push([design(timer__frequency_hz=16_000_000, **quick)] * axes, mode="try")()


# Fast ticks by hand, 32 a µs of pulse width: alone 106 + 32 w, two 246 + 64 w, on a line of two 133 + 32 w.
@pytest.mark.parametrize(
    ("speed", "width_us", "fastest", "widest_us"),
    [(100_000, 10, 37_558, 1), (150_943, 1, 115_942, 0), (40_000, 100, 4839, 9)],
)
def test_with_wide_pulses_it_is_told_what_would_do(
    controller: StepRampController, speed: int, width_us: int, fastest: int, widest_us: int
) -> None:
    quick_on(controller, speed)
    controller.use_settings(StepRampSettings(pulse_width_us=width_us))
    told = (
        f"axis 0 at most {fastest:,} steps/s, or with a pulse width of at most {widest_us} µs \\(now {width_us} µs\\)"
    )
    with pytest.raises(Rejected, match=told):
        controller.move_by([AxisCommand(0, 5, "by_steps")])
    controller.run([AxisCommand(0, fastest, "speed_steps_per_s")])
    controller.halt()
    controller.use_settings(StepRampSettings(pulse_width_us=widest_us))
    controller.move_by([AxisCommand(0, 5, "by_steps")])
    controller.halt()
    controller.use_settings(StepRampSettings(pulse_width_us=widest_us + 1))
    with pytest.raises(Rejected):
        controller.move_by([AxisCommand(0, 5, "by_steps")])


def test_with_wide_pulses_it_is_told_what_axes_and_lines_can_do(controller: StepRampController) -> None:
    quick_on(controller, 40_000, axes=2)
    controller.use_settings(StepRampSettings(pulse_width_us=9))
    told = (
        "axis 0 at most 19,464 steps/s, axis 1 at most 19,464 steps/s when they move at the same time, or fewer axes, "
        "or with a pulse width of at most 2 µs"
    )
    with pytest.raises(Rejected, match=told):
        controller.move_by(by_steps(5, 5))
    controller.run([AxisCommand(axis, 19_464, f"axes.{axis}") for axis in range(2)])
    controller.halt()
    with pytest.raises(Rejected, match=r"at most 38,004 steps/s, for a line of 2 axes, or with .* at most 8 µs"):
        controller.line(by_steps(5, 5))
    controller.line([*by_steps(5, 0)])
    controller.halt()
    controller.use_settings(StepRampSettings(pulse_width_us=8))
    controller.line(by_steps(5, 5))
