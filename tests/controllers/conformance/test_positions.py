from __future__ import annotations

from controllers.conformance.answers import moved, refused
from controllers.protocol_line import Line
from controllers.ramps import four_axes
from stepramp.controllers.stepramp.messages.motion import MoveByRequest, SetPositionRequest, ZeroRequest
from stepramp.controllers.stepramp.messages.reply import ReplyStatus
from stepramp.controllers.stepramp.messages.status import MachineState


def test_positions_are_set_and_nothing_moves(line: Line) -> None:
    line.use(four_axes())
    line.good(SetPositionRequest(0b0110, (-2000, 2**31 - 1)))
    assert [line.status(axis).position_steps for axis in range(4)] == [0, -2000, 2**31 - 1, 0]
    assert line.status(1).target_steps == -2000
    assert line.status().state == MachineState.IDLE
    refused(line, MoveByRequest(4, (1,)), ReplyStatus.OUT_OF_RANGE, 2)
    assert moved(line, MoveByRequest(2, (5,))) == (-1995,)


def test_a_gauge_runs_to_its_stop(line: Line) -> None:
    line.use(four_axes())
    line.good(ZeroRequest(0b0011, 100))
    assert line.status(0).target_steps == 0
    line.wait_for_rest()
    status = line.status(1)
    assert (status.position_steps, status.steps_made) == (0, 100)
