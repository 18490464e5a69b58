import struct
from itertools import pairwise

from firmware import protocol as p
from firmware.controller.client import BYTE_US, SESSION, Controller, timed_messages
from firmware.controller.ramps import RAMP, TWO_AXES
from firmware.protocol import Report, for_axes


def test_reports_come_as_often_as_asked(controller: Controller) -> None:
    controller.push(TWO_AXES)
    controller.ok(p.SET_POSITION, for_axes({0: -5, 1: 77}))
    a_second = round(1e6 / BYTE_US)
    for rate in (50, 10, 1):
        controller.ok(p.REPORT, bytes([rate]))
        reports = [message for _, message in timed_messages(controller, a_second)]
        assert len(reports) in (rate - 1, rate, rate + 1)
        assert all(each[0] == p.REPORT_NOTICE and each[1:3] == struct.pack("<H", SESSION) for each in reports)
        assert [each[3] - reports[0][3] & 255 for each in reports] == list(range(len(reports)))
        said = [Report.unpack(each[4:]) for each in reports]
        assert {(each.positions, each.intervals, each.states) for each in said} == {((-5, 77), (0, 0), (0, 0, 0, 0))}
        times = [each.time_ms for each in said]
        assert all((b - a & 0xFFFF) - 1000 // rate in (-1, 0, 1) for a, b in pairwise(times))
    assert controller.refused(p.REPORT, b"\x33") == (p.OUT_OF_RANGE, 51)
    controller.ok(p.REPORT, b"\0")
    assert timed_messages(controller, a_second) == []


def test_reports_follow_a_move(controller: Controller) -> None:
    controller.push(TWO_AXES)
    controller.ok(p.REPORT, b"\x32")
    controller.notices.clear()
    frame = controller.frame(p.MOVE_BY, for_axes({1: 300}))
    sent = timed_messages(controller, round(1e6 / BYTE_US), frame)
    said = [Report.unpack(message[4:]) for _, message in sent if message[0] == p.REPORT_NOTICE]
    positions = [each.positions[1] for each in said]
    assert positions == sorted(positions)
    assert (positions[-1], said[-1].states) == (300, (0, 0, 0, 0))
    assert {each.states for each in said} == {(0, 0, 0, 0), (0, 1, 0, 0)}
    assert any(3000 <= each.intervals[1] <= 5000 for each in said)


def test_a_hello_ends_reports_and_traces(controller: Controller) -> None:
    controller.push(RAMP)
    controller.ok(p.REPORT, b"\x32")
    controller.ok(p.TRACE, b"\0\1\0")
    controller.hello()
    controller.ok(p.MOVE_BY, for_axes({0: 50}))
    assert timed_messages(controller, 10_000) == []
