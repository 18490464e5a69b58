from __future__ import annotations

from itertools import takewhile

import pytest

from controllers.conformance.answers import LONG_MOVE, moved, refused, reports
from controllers.protocol_line import Line
from controllers.ramps import IMAGE, SIDE, four_axes, image_of
from stepramp.controllers.stepramp.messages.motion import (
    HaltRequest,
    MoveByRequest,
    MoveToRequest,
    RunRequest,
    SetPositionRequest,
    StopRequest,
)
from stepramp.controllers.stepramp.messages.reply import ReplyStatus
from stepramp.controllers.stepramp.messages.report import ReportRequest
from stepramp.controllers.stepramp.messages.status import AxisState, MachineState
from stepramp.controllers.stepramp.ramp_image import SegmentRamp
from stepramp.ramp.segments import Segment


@pytest.mark.parametrize("target", [-50, 0, 1, 20, 90, 2000])
@pytest.mark.parametrize("wait_s", [0.0, 0.01, 0.1])
def test_a_target_that_changes_in_flight_is_reached(line: Line, target: int, wait_s: float) -> None:
    line.use(IMAGE)
    moved(line, MoveByRequest(1, (150,)))
    line.hear(wait_s)
    assert moved(line, MoveToRequest(1, (target,))) == (target,)
    status = line.wait_for_rest()
    assert status.position_steps == status.target_steps == target
    assert status.starved == 0


def test_a_move_by_in_flight_counts_from_where_it_would_come_to_rest(line: Line) -> None:
    line.use(IMAGE)
    moved(line, MoveByRequest(1, (150,)))
    assert moved(line, MoveByRequest(1, (-250,))) == (-100,)
    assert moved(line, MoveByRequest(1, (30,))) == (-70,)
    assert line.wait_for_rest().position_steps == -70


def test_a_farther_target_while_slowing_down_speeds_it_up_again(line: Line) -> None:
    slow = image_of(SegmentRamp(SIDE, 1000, (Segment(60_000, 40, -1500),)))
    line.use(slow)
    moved(line, MoveByRequest(1, (100,)))
    line.wait_until(lambda status: status.steps_made > 70 and status.interval_ticks > 5000)
    moved(line, MoveToRequest(1, (400,)))
    line.wait_until(lambda status: status.interval_ticks == 1000)
    line.good(HaltRequest())


def test_running_at_a_speed_and_changing_it(line: Line) -> None:
    line.use(IMAGE)
    line.good(RunRequest(1, (1500,)))
    line.wait_until(lambda status: status.interval_ticks == 1500)
    for _ in range(40):
        status = line.status()
        assert (status.axis_state, status.target_steps) == (AxisState.MOVING, status.position_steps)
    line.good(RunRequest(1, (1000,)))
    line.wait_until(lambda status: status.interval_ticks == 1000)
    line.good(RunRequest(1, (3000,)))
    assert line.wait_until(lambda status: status.interval_ticks == 3000).position_steps > 0
    line.good(RunRequest(1, (-1200,)))
    line.wait_until(lambda status: status.interval_ticks == 1200 and status.position_steps < 0)
    line.good(RunRequest(1, (0,)))
    status = line.wait_for_rest()
    assert status.position_steps == status.target_steps < 0


def test_a_run_goes_on_past_the_last_position(line: Line) -> None:
    """To the first: positions count modulo 2³²."""
    line.use(IMAGE)
    line.good(SetPositionRequest(1, (2**31 - 60,)))
    line.good(RunRequest(1, (2500,)))
    status = line.wait_until(lambda status: status.position_steps < 0)
    assert status.axis_state == AxisState.MOVING
    assert status.position_steps == status.steps_made - 60 - 2**31
    line.good(StopRequest())
    after, end = line.status(), line.wait_for_rest()
    assert after.target_steps == end.target_steps == end.position_steps == end.steps_made - 60 - 2**31


def test_a_move_ends_a_run(line: Line) -> None:
    line.use(IMAGE)
    line.good(RunRequest(1, (2500,)))
    line.wait_until(lambda status: status.interval_ticks == 2500)
    moved(line, MoveToRequest(1, (500,)))
    assert line.wait_for_rest().position_steps == 500


def test_a_move_by_counts_from_where_a_run_is(line: Line) -> None:
    """Or from what is queued already: 10 ms ahead at most, at an interval of 1.25 ms."""
    line.use(IMAGE)
    line.good(RunRequest(1, (2500,)))
    before = line.wait_until(lambda status: status.interval_ticks == 2500)
    (target,) = moved(line, MoveByRequest(1, (400,)))
    after = line.status()
    assert before.position_steps + 400 <= target <= after.position_steps + 400 + 8 + 1
    assert line.wait_for_rest().position_steps == target


def test_a_run_ends_when_nobody_asks_for_anything_and_a_move_goes_on(line: Line) -> None:
    line.use(four_axes())
    line.good(ReportRequest(50))
    moved(line, MoveByRequest(2, (LONG_MOVE,)))
    line.good(RunRequest(1, (1500,)))
    for _ in range(6):  # any request keeps it running
        line.hear(0.4)
        assert line.status().axis_state == AxisState.MOVING
    refused(line, MoveByRequest(1, (2**31 - 1,)), ReplyStatus.OUT_OF_RANGE, 0)  # changes nothing of it
    line.notices.clear()
    for _ in range(100):
        line.hear(0.1)
        if any(report.state_of(0) == AxisState.IDLE for report in reports(line)):
            break
    told = reports(line)
    running = list(takewhile(lambda report: report.state_of(0) == AxisState.MOVING, told))
    # It happened between the last report of the one and the first of the other: on a busy machine some are left out.
    assert (running[-1].time_ms - told[0].time_ms) % 2**16 <= 1350
    assert (told[len(running)].time_ms - told[0].time_ms) % 2**16 >= 950
    assert told[-1].state_of(0) == AxisState.IDLE
    assert told[-1].state_of(1) == AxisState.MOVING
    line.good(StopRequest())
    line.wait_for_rest()


def test_speeds_that_no_ramp_leads_to(line: Line) -> None:
    line.use(four_axes())
    refused(line, RunRequest(1, (999,)), ReplyStatus.OUT_OF_RANGE, 0)
    refused(line, RunRequest(3, (1000, -899)), ReplyStatus.OUT_OF_RANGE, 1)
    refused(line, RunRequest(1, (2**28,)), ReplyStatus.OUT_OF_RANGE, 0)
    assert line.status().state == MachineState.IDLE
