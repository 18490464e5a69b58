import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepramp.controllers.stepramp import trace as trace_module
from stepramp.controllers.stepramp.messages.trace import TRACE_LAST, TraceNotice
from stepramp.controllers.stepramp.trace import TraceCollector, TracedMove, extended
from stepramp.controllers.virtual.streams import ReportClock, TraceRecorder
from stepramp.numerics.ramp import Ramp
from stepramp.ramp.line import steps_together
from stepramp.ramp.playback.lists import ListPlayback

HZ = 2_000_000
PLAYBACK = ListPlayback(Ramp(np.array([90_000, 70_000]), 50_000, np.array([90_000, 70_000])))


def plan(steps: int) -> TracedMove:
    return TracedMove(PLAYBACK.trajectory(PLAYBACK.rest, steps))


@given(
    st.lists(st.integers(1, 10**7), min_size=1, max_size=50),
    st.lists(st.integers(-(2**14), 2**14), min_size=50, max_size=50),
    st.integers(0, 2**16 - 1),
)
def test_values_are_extended_to_within_half_a_wrap_of_the_plan(
    intervals: list[int], late: list[int], begin: int
) -> None:
    planned = np.cumsum(intervals)
    measured = planned + np.array(late[: planned.size]) - late[0]
    values = (measured + begin) % 2**16
    assert extended(values, planned).tolist() == measured.tolist()


def test_no_values() -> None:
    assert extended(np.empty(0, np.int64), np.empty(0, np.int64)).size == 0


def test_a_trace_of_a_whole_move() -> None:
    collector = TraceCollector(1, 2)
    assert collector.trace() is None
    collector.begin(lambda: plan(7), HZ, 1)
    instants = np.array([0, 160_000, 260_000, 380_000 - 10_000])
    told = (instants + np.array([0, 5, -3, 10]) + 12_345) % 2**16
    collector.take(TraceNotice(1, 2, 1, tuple(told[:3].tolist())))
    trace = collector.trace()()
    assert trace is not None
    assert (trace.complete, trace.changed, trace.step.tolist()) == (False, False, [1, 3, 5])
    collector.take(TraceNotice(1 | TRACE_LAST, 2, 7, tuple(told[3:].tolist())))
    trace = collector.trace()()
    assert trace is not None
    assert trace.complete
    assert trace.step.tolist() == [1, 3, 5, 7]
    assert trace.planned_ticks.tolist() == [0, 160_000, 260_000, 380_000]
    assert trace.measured_ticks.tolist() == [0, 160_005, 259_997, 370_010]
    assert trace.deviation_us.tolist() == [0.0, 2.5, -1.5, -4995.0]


def test_values_that_the_port_could_not_carry_are_left_out() -> None:
    collector = TraceCollector(0, 1)
    collector.begin(lambda: plan(7), HZ, 1)
    collector.take(TraceNotice(0, 1, 1, (100,)))
    collector.take(TraceNotice(TRACE_LAST, 1, 6, ((100 + 310_000) % 2**16, (100 + 380_000) % 2**16)))
    trace = collector.trace()()
    assert trace is not None
    assert trace.step.tolist() == [1, 6, 7]
    assert trace.deviation_us.tolist() == [0, 0, 0]


def test_what_is_not_of_this_move_is_left_out() -> None:
    collector = TraceCollector(0, 1)
    collector.take(TraceNotice(0, 1, 1, (5,)))
    collector.begin(lambda: plan(3), HZ, 1)
    collector.take(TraceNotice(2, 1, 1, (5,)))
    collector.take(TraceNotice(TRACE_LAST, 1, 1, (7,)))
    collector.take(TraceNotice(0, 1, 1, (9,)))
    trace = collector.trace()()
    assert trace is not None
    assert (trace.complete, trace.step.tolist()) == (True, [1])


def test_a_trace_that_never_ends_is_kept_so_far(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run may last for days: what doesn't fit is left out, and what came before stays."""
    monkeypatch.setattr(trace_module, "MOST_STEPS", 5)
    collector = TraceCollector(0, 1)
    collector.begin(lambda: plan(1000), HZ, 1)
    for first in range(1, 990, 3):
        collector.take(TraceNotice(0, 1, first, (0, 0, 0)))
    collector.take(TraceNotice(TRACE_LAST, 1, 1000, (0,)))
    trace = collector.trace()()
    assert (trace.complete, trace.changed, trace.step.tolist()) == (False, False, [1, 2, 3])
    assert not collector.is_under_way
    collector.begin(lambda: plan(2), HZ, 1)
    collector.take(TraceNotice(TRACE_LAST, 1, 1, (0, 0)))
    assert (collector.trace()().complete, collector.trace()().step.tolist()) == (True, [1, 2])


def test_a_trace_ends_where_the_move_was_changed() -> None:
    collector = TraceCollector(0, 1)
    collector.change()
    collector.begin(lambda: plan(7), HZ, 1)
    collector.take(TraceNotice(0, 1, 1, (0,)))
    collector.change()
    collector.take(TraceNotice(TRACE_LAST, 1, 2, (1, 2)))
    trace = collector.trace()()
    assert trace is not None
    assert (trace.complete, trace.changed, trace.step.tolist()) == (True, True, [1])


def test_the_trace_of_a_follower_begins_with_its_first_step() -> None:
    trajectory = PLAYBACK.trajectory(PLAYBACK.rest, 7)
    followed = TracedMove(trajectory, steps_together(7, 2))
    # Steps 1 and 2 of 2 come with the leader's ceil(7 / 4) = 2nd and ceil(21 / 4) = 6th.
    assert followed.instants(np.array([1, 2])).tolist() == [90_000, 310_000]
    collector = TraceCollector(0, 1)
    collector.begin(lambda: followed, HZ, 1)
    collector.take(TraceNotice(TRACE_LAST, 1, 1, (7, (7 + 220_000) % 2**16)))
    trace = collector.trace()()
    assert trace is not None
    assert trace.planned_ticks.tolist() == trace.measured_ticks.tolist() == [0, 220_000]


@pytest.mark.parametrize("every", [1, 3, 7])
@pytest.mark.parametrize("at_once", [1, 5, 100])
def test_the_virtual_controller_records_every_so_many_th_step(every: int, at_once: int) -> None:
    recorder = TraceRecorder(2, every)
    recorder.set_out()
    for first in range(1, 101, at_once):
        recorder.pulses(first, min(at_once, 101 - first), lambda pulses: 1000 * pulses)
    recorder.at_rest()
    frames = list(recorder.frames())
    steps = [frame.first_step + every * place for frame in frames for place in range(len(frame.values))]
    assert steps == list(range(1, 101, every))
    assert [value for frame in frames for value in frame.values] == [1000 * step % 2**16 for step in steps]
    assert [frame.is_last for frame in frames] == [False] * (len(frames) - 1) + [True]
    assert {frame.axis for frame in frames} == {2}
    assert max(len(frame.values) for frame in frames) <= 20
    assert list(recorder.frames()) == []


def test_a_trace_that_is_asked_for_in_a_move_begins_with_the_next_one() -> None:
    recorder = TraceRecorder(0, 1)
    recorder.pulses(5, 3, lambda pulses: pulses)
    recorder.at_rest()
    assert list(recorder.frames()) == []


def test_reports_never_queue_up() -> None:
    reports = ReportClock()
    assert not reports.is_due(5.0)
    reports.start(10, 1.0)
    assert reports.is_due(1.0)
    assert not reports.is_due(1.05)
    assert reports.is_due(1.5)
    assert not reports.is_due(1.55)
    assert reports.is_due(1.6)
    reports.start(0, 2.0)
    assert not reports.is_due(9.0)
