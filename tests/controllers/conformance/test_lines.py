from __future__ import annotations

import pytest

from controllers.conformance.answers import LONG_MOVE, moved, refused
from controllers.protocol_line import Line
from controllers.ramps import four_axes
from stepramp.controllers.stepramp.messages.motion import (
    HaltRequest,
    LineRequest,
    MoveByRequest,
    MoveToRequest,
    RunRequest,
    StopRequest,
)
from stepramp.controllers.stepramp.messages.reply import ReplyStatus
from stepramp.controllers.stepramp.messages.status import AxisState, MachineState


@pytest.mark.parametrize("steps", [(300, 100, 0, -7), (-50, 120, 120, 1), (1, -1, 0, 0), (0, 0, -83, 0), (0, 5, 0, 0)])
def test_a_line_ends_exactly_where_it_should(line: Line, steps: tuple[int, ...]) -> None:
    line.use(four_axes())
    assert moved(line, LineRequest(15, 0, steps)) == steps
    line.wait_for_rest()
    assert [line.status(axis).position_steps for axis in range(4)] == list(steps)


def test_axes_keep_to_the_line(line: Line) -> None:
    line.use(four_axes())
    moved(line, LineRequest(0b0101, 0, (3000, -1000)))
    refused(line, MoveByRequest(2, (1,)), ReplyStatus.MOVING)
    refused(line, RunRequest(2, (5000,)), ReplyStatus.MOVING)
    for _ in range(5):
        before, follower = line.status(0), line.status(2)
        after = line.status(0)
        assert before.position_steps / 3 - 1 <= -follower.position_steps <= after.position_steps / 3 + 1
    line.good(StopRequest(bytes([4])))
    line.wait_for_rest()
    leader, follower = (line.status(axis).position_steps for axis in (0, 2))
    assert 0 < leader < 3000
    assert -follower == (2 * leader * 1000 + 3000) // 6000
    moved(line, MoveToRequest(0b0101, (0, 0)))
    assert line.wait_for_rest().position_steps == 0


def test_a_halt_ends_a_line(line: Line) -> None:
    line.use(four_axes())
    moved(line, LineRequest(3, 1, (3000, 3000)))
    line.hear(0.1)
    line.good(HaltRequest())
    assert line.status().state == MachineState.IDLE
    assert 0 < line.status(0).position_steps == line.status(1).position_steps < 3000


def test_axes_beside_a_line_do_not_end_it(line: Line) -> None:
    """Nor does a run of one of them that has ended before, when nobody asks for anything."""
    line.use(four_axes())
    line.good(RunRequest(0b0110, (2500, 1500)))
    line.good(StopRequest())
    line.wait_for_axis(1)
    line.wait_for_axis(2)
    moved(line, LineRequest(0b0011, 0, (LONG_MOVE, 0)))
    line.hear(1.6)
    for request in (StopRequest(bytes([0b0110])), HaltRequest(bytes([0b1110]))):
        assert line.status().axis_state == AxisState.MOVING
        line.good(request)
    assert line.status().axis_state == AxisState.MOVING
    line.good(HaltRequest(bytes([0b1001])))
    assert line.status().state == MachineState.IDLE


def test_a_line_with_the_ramp_of_no_axis(line: Line) -> None:
    line.use(four_axes())
    refused(line, LineRequest(3, 4, (5, 5)), ReplyStatus.OUT_OF_RANGE, 4)
