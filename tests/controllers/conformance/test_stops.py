from __future__ import annotations

import pytest

from controllers.conformance.answers import LONG_MOVE, moved, refused
from controllers.protocol_line import Line
from controllers.ramps import DOWN_STEPS, IMAGE, SIDE, four_axes, image_of
from stepramp.controllers.stepramp.messages.motion import HaltRequest, MoveByRequest, MoveToRequest, StopRequest
from stepramp.controllers.stepramp.messages.reply import ReplyStatus
from stepramp.controllers.stepramp.messages.status import AxisState, MachineState
from stepramp.controllers.stepramp.ramp_image import SegmentRamp
from stepramp.ramp.segments import Segment


@pytest.mark.parametrize("wait_s", [0.0, 0.01, 0.02, 0.2])
def test_a_stop_follows_the_ramp_down(line: Line, wait_s: float) -> None:
    line.use(IMAGE)
    moved(line, MoveByRequest(1, (-LONG_MOVE,)))
    line.hear(wait_s)
    before = line.status()
    line.good(StopRequest())
    after = line.status()
    end = line.wait_for_rest()
    assert before.axis_state == AxisState.MOVING
    assert after.axis_state in (AxisState.STOPPING, AxisState.IDLE)
    assert end.position_steps == end.target_steps == after.target_steps == -end.steps_made
    assert before.steps_made <= end.steps_made < LONG_MOVE
    longer = [interval for interval in DOWN_STEPS if interval > before.interval_ticks > 0]
    assert end.steps_made - before.steps_made >= len(longer)
    line.good(StopRequest())
    assert line.status().position_steps == end.position_steps


def test_a_stop_on_the_ramp_down_changes_nothing(line: Line) -> None:
    line.use(image_of(SegmentRamp(SIDE, 1000, (Segment(60_000, 40, -1500),))))
    moved(line, MoveByRequest(1, (100,)))
    line.wait_until(lambda status: status.steps_made > 75)
    line.good(StopRequest())
    assert line.status().axis_state == AxisState.STOPPING
    assert line.wait_for_rest().position_steps == 100


def test_one_axis_stops_and_the_other_goes_on(line: Line) -> None:
    line.use(four_axes())
    moved(line, MoveByRequest(3, (LONG_MOVE, LONG_MOVE)))
    line.good(StopRequest(bytes([2])))
    assert line.wait_for_axis(1).position_steps < LONG_MOVE
    assert line.status(0).axis_state == AxisState.MOVING
    refused(line, StopRequest(bytes([16])), ReplyStatus.OUT_OF_RANGE, 16)
    line.good(StopRequest())
    assert line.wait_for_rest().position_steps < LONG_MOVE


def test_a_move_after_a_stop_in_flight_goes_on(line: Line) -> None:
    line.use(IMAGE)
    moved(line, MoveByRequest(1, (LONG_MOVE,)))
    line.hear(0.05)
    line.good(StopRequest())
    moved(line, MoveToRequest(1, (400,)))
    assert line.wait_for_rest().position_steps == 400


def test_a_halt_is_at_once_and_keeps_the_position(line: Line) -> None:
    line.use(IMAGE)
    moved(line, MoveByRequest(1, (LONG_MOVE,)))
    line.hear(0.1)
    line.good(HaltRequest())
    status = line.status()
    assert (status.state, status.interval_ticks) == (MachineState.IDLE, 0)
    assert 0 < status.position_steps == status.target_steps == status.steps_made < LONG_MOVE
    assert line.status() == status
    moved(line, MoveToRequest(1, (0,)))
    assert line.wait_for_rest().position_steps == 0


def test_stop_and_halt_at_rest_do_nothing(line: Line) -> None:
    for request in (StopRequest(), HaltRequest()):
        line.good(request)
        assert line.status().state == MachineState.IDLE
