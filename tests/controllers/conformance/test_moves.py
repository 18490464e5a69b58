from __future__ import annotations

import pytest

from controllers.conformance.answers import LONG_MOVE, moved, refused
from controllers.protocol_line import Line
from controllers.ramps import FAST_IMAGE, IMAGE, four_axes
from stepramp.controllers.stepramp.messages.motion import (
    HaltRequest,
    LineRequest,
    MoveByRequest,
    MoveToRequest,
    SetPositionRequest,
    ZeroRequest,
)
from stepramp.controllers.stepramp.messages.ramps import (
    BeginRequest,
    CommitRequest,
    DataRequest,
    EndRequest,
    RollBackRequest,
    TryRequest,
)
from stepramp.controllers.stepramp.messages.reply import ReplyStatus
from stepramp.controllers.stepramp.messages.settings import WriteSettingsRequest
from stepramp.controllers.stepramp.messages.status import AxisState, MachineState
from stepramp.controllers.stepramp.settings import StepRampSettings


@pytest.mark.parametrize("steps", [1, 2, 3, 42, 43, 44, 82, 83, 84, 300, -1, -83, -300])
def test_a_move_ends_exactly_where_it_should(line: Line, steps: int) -> None:
    line.use(IMAGE)
    assert moved(line, MoveByRequest(1, (steps,))) == (steps,)
    status = line.wait_for_rest()
    assert (status.position_steps, status.target_steps, status.interval_ticks) == (steps, steps, 0)
    assert (status.steps_made, status.starved) == (abs(steps), 0)


def test_positions_add_up(line: Line) -> None:
    line.use(FAST_IMAGE)
    position = 0
    for steps in (10, -30, 7, 120, -107):
        position += steps
        assert moved(line, MoveByRequest(1, (steps,))) == (position,)
        assert line.wait_for_rest().position_steps == position
    assert moved(line, MoveToRequest(1, (position,))) == (position,)
    assert line.wait_for_rest().position_steps == position


def test_targets_that_are_too_far(line: Line) -> None:
    line.use(four_axes())
    moved(line, MoveByRequest(2, (5,)))
    line.wait_for_rest()
    refused(line, MoveByRequest(3, (0, 2**31 - 1)), ReplyStatus.OUT_OF_RANGE, 1)
    assert line.status().state == MachineState.IDLE


@pytest.mark.parametrize("mask", [0, 16, 255])
def test_axes_without_a_ramp(line: Line, mask: int) -> None:
    line.use(four_axes())
    values = (1,) * mask.bit_count()
    for request in (MoveByRequest(mask, values), SetPositionRequest(mask, values), ZeroRequest(mask, 5)):
        refused(line, request, ReplyStatus.OUT_OF_RANGE, mask)


def test_axes_move_at_the_same_time_each_with_its_ramp(line: Line) -> None:
    line.use(four_axes())
    assert moved(line, MoveByRequest(0b1011, (300, -200, 50))) == (300, -200, 50)
    assert line.status(2).axis_state == AxisState.IDLE
    line.wait_for_rest()
    assert [line.status(axis).position_steps for axis in range(4)] == [300, -200, 0, 50]
    assert [line.status(axis).steps_made for axis in (0, 1, 3)] == [300, 200, 50]


def test_an_axis_sets_out_while_another_moves(line: Line) -> None:
    line.use(four_axes())
    moved(line, MoveByRequest(1, (LONG_MOVE,)))
    moved(line, MoveToRequest(4, (-60,)))
    assert line.wait_for_axis(2).position_steps == -60
    assert line.status(0).axis_state == AxisState.MOVING
    line.good(HaltRequest(bytes([1])))
    assert line.wait_for_rest().position_steps > 0


def test_what_is_refused_while_moving(line: Line) -> None:
    line.store(IMAGE)
    moved(line, MoveByRequest(1, (LONG_MOVE,)))
    for request in (
        BeginRequest(1, 0),
        DataRequest(0, b"x"),
        EndRequest(),
        CommitRequest(),
        TryRequest(),
        RollBackRequest(),
        WriteSettingsRequest(StepRampSettings().pack()),
        SetPositionRequest(1, (0,)),
        ZeroRequest(1, 5),
        LineRequest(1, 0, (5,)),
    ):
        refused(line, request, ReplyStatus.MOVING)
    assert line.read_image() == IMAGE.encode()
    status = line.wait_until(lambda status: status.steps_made > 0)
    assert (status.state, status.axis_state, status.target_steps) == (1, AxisState.MOVING, LONG_MOVE)
    assert 0 < status.position_steps <= status.steps_made + 1
    assert line.hello().ramp_sequence == 1
    assert line.status().state == MachineState.MOVING
    line.good(HaltRequest())
