from __future__ import annotations

import numpy as np
import pytest

from controllers.conformance.answers import LONG_MOVE, TOLERANCE_US, moved, refused, reports
from controllers.protocol_line import SESSION, Line
from controllers.ramps import IMAGE, four_axes, image_of
from stepramp.controllers.stepramp.messages.motion import HaltRequest, MoveByRequest
from stepramp.controllers.stepramp.messages.reply import ReplyStatus
from stepramp.controllers.stepramp.messages.report import ReportRequest
from stepramp.controllers.stepramp.messages.trace import TRACE_OFF, TraceNotice, TraceReply, TraceRequest
from stepramp.controllers.stepramp.ramp_image import SegmentRamp
from stepramp.ramp.segments import Segment


def test_reports_come_as_often_as_asked_for(line: Line) -> None:
    line.use(four_axes())
    line.hear(0.1)
    assert line.notices == []
    refused(line, ReportRequest(51), ReplyStatus.OUT_OF_RANGE, 51)
    line.good(ReportRequest(50))
    moved(line, MoveByRequest(5, (LONG_MOVE, -LONG_MOVE)))
    line.hear(1.0)
    line.good(ReportRequest(0))
    # By the controller's own clock: on a busy machine all is late, and what the line has no room for is left out.
    pauses_ms = np.diff([report.time_ms for report in reports(line)]) % 65_536
    assert 18 <= np.median(pauses_ms) <= 28
    assert pauses_ms.mean() >= 18
    tags = [message.tag for message, _ in line.notices]
    assert [(tag - tags[0]) % 256 for tag in tags] == list(range(len(tags)))
    assert {message.session for message, _ in line.notices} == {SESSION}
    positions = [report.axes[0][0] for report in reports(line)]
    assert positions == sorted(positions)
    last = reports(line)[-1]
    assert [last.state_of(axis) for axis in range(4)] == [1, 0, 1, 0]
    assert (last.axes[0][1], last.axes[1]) == (1000, (0, 0))
    line.hear(0.1)
    line.notices.clear()
    line.hear(0.1)
    assert line.notices == []
    line.good(HaltRequest())


def test_a_hello_ends_reports(line: Line) -> None:
    line.use(IMAGE)
    line.good(ReportRequest(50))
    line.hear(0.1)
    assert reports(line)
    line.hello()
    line.notices.clear()
    line.hear(0.1)
    assert line.notices == []


def traced(line: Line) -> tuple[np.ndarray, np.ndarray, bool]:
    """Return the steps, the timer's values, and whether the last frame came."""
    frames = [notice for _, notice in line.notices if isinstance(notice, TraceNotice)]
    steps = [frame.first_step + frame.every_steps * index for frame in frames for index in range(len(frame.values))]
    values = [value for frame in frames for value in frame.values]
    return np.array(steps), np.array(values), any(frame.is_last for frame in frames)


@pytest.mark.parametrize("every", [1, 3])
@pytest.mark.parametrize("steps", [2, 60, -200])
def test_a_trace_tells_when_steps_were_made(line: Line, every: int, steps: int) -> None:
    slow = image_of(SegmentRamp((Segment(20_000, 20, -400),), 8000, (Segment(20_000, 20, -400),)))
    line.use(slow)
    assert line.good(TraceRequest(0, every), TraceReply) == TraceReply(every)
    moved(line, MoveByRequest(1, (steps,)))
    line.wait_for_rest()
    line.hear(0.3)
    numbers, values, complete = traced(line)
    assert complete
    assert max(len(notice.values) for _, notice in line.notices if isinstance(notice, TraceNotice)) <= 12
    assert numbers.tolist() == list(range(1, abs(steps) + 1, every))
    up = 20_000 - 400 * np.arange(20)
    n_up, n_down = (min(20, -(-abs(steps) // 2)), min(20, abs(steps) // 2))
    intervals = np.concatenate((up[:n_up], np.full(abs(steps) - n_up - n_down, 8000), up[:n_down][::-1]))
    planned = np.concatenate(([0], np.cumsum(intervals)))[numbers - 1]
    late = (values - values[0] - planned + 2**15) % 2**16 - 2**15
    assert np.abs(late).max() <= TOLERANCE_US * 2
    line.good(TraceRequest(TRACE_OFF, 0), TraceReply)


def test_the_controller_chooses_what_the_line_can_carry(line: Line) -> None:
    line.use(IMAGE)
    assert line.good(TraceRequest(0, 0), TraceReply) == TraceReply(2)
    refused(line, TraceRequest(1, 0), ReplyStatus.OUT_OF_RANGE, 1)
