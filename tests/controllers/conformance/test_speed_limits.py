from __future__ import annotations

from controllers.conformance.answers import LONG_MOVE, moved
from controllers.protocol_line import Line
from stepramp.controllers.stepramp.messages.motion import HaltRequest, LineRequest, MoveByRequest, RunRequest
from stepramp.controllers.stepramp.messages.reply import Refusal, ReplyStatus
from stepramp.controllers.stepramp.messages.settings import WriteSettingsRequest
from stepramp.controllers.stepramp.messages.status import MachineState
from stepramp.controllers.stepramp.ramp_image import RampImage, SegmentRamp
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.ramp.segments import Segment


def fast_axes(interval: int, axes: int = 4) -> RampImage:
    ramp = SegmentRamp((Segment(20_000, 20, -100),), interval, (Segment(20_000, 20, -100),))
    return RampImage(True, (ramp,) * axes)


def test_axes_that_are_too_fast_together(line: Line) -> None:
    line.use(fast_axes(500))
    for mask in (1, 3, 7):
        values = (5,) * mask.bit_count()
        moved(line, MoveByRequest(mask, values))
        line.wait_for_rest()
    reply = line.ask(MoveByRequest(15, (5,) * 4))
    assert isinstance(reply, Refusal)
    assert reply.status is ReplyStatus.TOO_FAST
    assert reply.detail in range(105, 108)
    moved(line, MoveByRequest(7, (LONG_MOVE,) * 3))
    assert line.ask(MoveByRequest(8, (5,))).status is ReplyStatus.TOO_FAST
    assert line.ask(RunRequest(8, (500,))).status is ReplyStatus.TOO_FAST
    line.good(RunRequest(8, (900,)))
    line.good(HaltRequest())


def test_an_axis_that_slows_down_is_still_fast(line: Line) -> None:
    """Whether it is told so in the same request or before."""
    long_ramp_down = (Segment(220, 60_000, 0),)
    line.use(RampImage(True, (SegmentRamp((), 200, long_ramp_down), SegmentRamp((), 260, ()))))
    line.good(RunRequest(1, (200,)))
    line.wait_until(lambda status: status.interval_ticks == 200)
    assert line.ask(RunRequest(3, (100_000, 260))).status is ReplyStatus.TOO_FAST
    assert line.ask(RunRequest(3, (0, 260))).status is ReplyStatus.TOO_FAST
    line.good(RunRequest(1, (100_000,)))
    assert line.ask(RunRequest(2, (260,))).status is ReplyStatus.TOO_FAST
    line.wait_until(lambda status: status.interval_ticks == 100_000)
    line.good(RunRequest(2, (260,)))
    line.good(HaltRequest())


def test_wide_pulses_and_gauges_take_longer(line: Line) -> None:
    line.use(fast_axes(200, 1))
    moved(line, MoveByRequest(1, (5,)))
    line.wait_for_rest()
    line.good(WriteSettingsRequest(StepRampSettings(pulse_width_us=6).pack()))
    assert line.ask(MoveByRequest(1, (5,))).status is ReplyStatus.TOO_FAST
    line.good(WriteSettingsRequest(StepRampSettings(outputs="gauges").pack()))
    assert line.ask(MoveByRequest(1, (5,))).status is ReplyStatus.TOO_FAST


def test_a_line_that_is_too_fast(line: Line) -> None:
    line.use(fast_axes(170))
    moved(line, LineRequest(7, 0, (5, 5, 5)))
    line.wait_for_rest()
    reply = line.ask(LineRequest(15, 0, (5, 5, 5, 5)))
    assert isinstance(reply, Refusal)
    assert reply.status is ReplyStatus.TOO_FAST
    assert line.status().state == MachineState.IDLE
