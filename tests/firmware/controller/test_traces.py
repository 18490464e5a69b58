import struct

from firmware import protocol as p
from firmware.controller.client import Controller, timed_messages
from firmware.controller.ramps import RAMP
from firmware.protocol import Ramp, Trace, for_axes


def traced(controller: Controller, every: int, move: bytes, rounds: int = 20_000) -> list[Trace]:
    """Return the trace frames of a move of axis 0."""
    controller.ok(p.TRACE, struct.pack("<BH", 0, every))
    sent = timed_messages(controller, rounds, move)
    return [Trace.unpack(message[4:]) for _, message in sent if message[0] == p.TRACE_NOTICE]


def test_the_values_of_a_trace_are_the_times_of_the_steps(controller: Controller) -> None:
    """Ten steps apart, on a slow ramp, the differences are sums of ten intervals."""
    ramp = Ramp([(4000, 40, -50)], 2000, [(4000, 40, -50)])
    controller.push(ramp)
    said = traced(controller, 10, controller.frame(p.MOVE_BY, for_axes({0: 300})))
    values: dict[int, int] = {}
    for each in said:
        assert (each.axis, each.every) == (0, 10)
        values |= each.by_step()
    assert [each.is_last for each in said] == [False] * (len(said) - 1) + [True]
    assert list(values) == list(range(1, 301, 10))
    intervals = ramp.intervals(300)
    for step in list(values)[1:]:
        assert values[step] - values[step - 10] & 0xFFFF == sum(intervals[step - 11 : step - 1]) & 0xFFFF


def test_a_trace_goes_on_when_another_axis_sets_out(controller: Controller) -> None:
    controller.push(RAMP.image(2))
    controller.ok(p.TRACE, b"\0\x07\0")
    controller.ok(p.MOVE_BY, for_axes({0: 300}))
    sent = timed_messages(controller, 1500)
    for _ in range(3):
        sent += timed_messages(controller, 500, controller.frame(p.MOVE_BY, for_axes({1: 3})))
    sent += timed_messages(controller, 20_000)
    said = [Trace.unpack(message[4:]) for _, message in sent if message[0] == p.TRACE_NOTICE]
    values: dict[int, int] = {}
    for each in said:
        values |= each.by_step()
    assert list(values) == list(range(1, 301, 7))
    intervals = RAMP.intervals(300)
    for step in list(values)[1:]:
        assert values[step] - values[step - 7] & 0xFFFF == sum(intervals[step - 8 : step - 1]) & 0xFFFF


def test_what_the_line_cannot_carry_leaves_gaps(controller: Controller) -> None:
    controller.push(Ramp([(4000, 20, -150)], 250, []).image(fast=False))
    said = traced(controller, 1, controller.frame(p.MOVE_BY, for_axes({0: 20_000})), 40_000)
    steps = [step for each in said for step in each.by_step()]
    assert said[-1].is_last
    assert steps == sorted(set(steps))
    assert 1000 < len(steps) < 20_000
    assert controller.status().position == 20_000


def test_the_controller_chooses_how_much_it_traces(controller: Controller) -> None:
    """About 1000 values a second at slew speed."""
    controller.push(p.image_of([Ramp([], 250, []).packed(), Ramp([], 20_000, []).packed()], [0, 1]))
    assert controller.ok(p.TRACE, b"\0\0\0") == struct.pack("<H", 8)
    assert controller.ok(p.TRACE, b"\1\0\0") == struct.pack("<H", 1)
    assert controller.ok(p.TRACE, b"\1\x07\0") == struct.pack("<H", 7)
    assert controller.refused(p.TRACE, b"\2\0\0") == (p.OUT_OF_RANGE, 2)
    controller.ok(p.TRACE, b"\xff\0\0")
    controller.check(Ramp([], 1000, []).image(fast=True))
    controller.ok(p.TRY)
    assert controller.ok(p.TRACE, b"\0\0\0") == struct.pack("<H", 16)


def test_each_move_has_its_trace(controller: Controller) -> None:
    controller.push(RAMP)
    for steps in (40, -40):
        said = traced(controller, 10, controller.frame(p.MOVE_BY, for_axes({0: steps})), 40_000)
        assert [step for each in said for step in each.by_step()] == [1, 11, 21, 31]
        assert said[-1].is_last
