"""What the controller tells while it moves, on the simulated chip: traces and reports, against the real edges."""

from collections.abc import Callable

import numpy as np
import pytest

from firmware.checker import lateness_us
from firmware.protocol import (
    HELLO,
    REPORT,
    REPORT_NOTICE,
    SLOW_HZ,
    TRACE,
    TRACE_NOTICE,
    TRACE_OFF,
    Report,
    Trace,
)
from firmware.rig import BusyClient, Make, Played, RampDesign, Work, image, move_by, play

SLOW = RampDesign(5000, 50_000, 50_000, SLOW_HZ)
FAST = RampDesign(40_000, 1_000_000, 1_000_000)
QUICKEST = RampDesign(150_944, 8_000_000, 8_000_000)


def traced(k: int, *steps: int, axis: int = 0) -> Work:
    def work(client: BusyClient) -> None:
        granted = int.from_bytes(client.expect_ok(TRACE, bytes([axis]) + k.to_bytes(2, "little")), "little")
        assert granted >= max(k, 1)
        client.notices.clear()
        move_by(*steps)(client)
        while not any(notice[0] == TRACE_NOTICE and notice[4] & 0x80 for notice in client.notices):
            client.take(0.1)

    return work


def traces_of(played: Played) -> list[Trace]:
    return [Trace.unpack(notice[4:]) for notice in played.notices if notice[0] == TRACE_NOTICE]


def offsets(played: Played, plan: RampDesign, axis: int = 0) -> np.ndarray:
    """Return each value's timer tick less that of its edge, the smallest one as 0; all within half of 16 bits."""
    steps = played.steps(axis)
    values = {step: value for trace in traces_of(played) for step, value in trace.by_step().items()}
    assert all(trace.axis == axis for trace in traces_of(played))
    late = np.array([steps[step - 1] // plan.cycles_per_tick - value for step, value in sorted(values.items())])
    near = (late - late[0] + 2**15) % 2**16 - 2**15
    return near - near.min()


@pytest.mark.parametrize(
    ("plan", "k", "steps"),
    [
        (SLOW, 1, 300),
        (SLOW, 7, -900),
        (FAST, 64, 6000),
        (FAST, 0, -9000),
        (QUICKEST, 0, 40_000),
        (QUICKEST, 500, 40_000),
    ],
)
def test_a_trace_tells_when_steps_were_made(
    simulated_controller: Make, record_property: Callable[..., None], plan: RampDesign, k: int, steps: int
) -> None:
    """The values are the timer's at the edges but for a constant and what interrupts add; the steps are as planned."""
    played = play(simulated_controller, image([plan]), traced(k, steps))
    traces = traces_of(played)
    told = [step for trace in traces for step in trace.by_step()]
    every = traces[0].every
    assert every * plan.slew * plan.cycles_per_tick >= 16_000  # no more than 1000 a second
    assert every == k or (every - 1) * plan.slew * plan.cycles_per_tick < 16_000
    assert told == sorted(told)
    assert told[0] == 1
    assert {(step - 1) % every for step in told} == {0}
    assert len(told) >= 0.5 * min(abs(steps) / every, 100)
    assert [trace.is_last for trace in traces] == [False] * (len(traces) - 1) + [True]
    spread_us = offsets(played, plan).max() * plan.cycles_per_tick / 16
    record_property("spread_us", float(spread_us))
    assert spread_us <= 5 + plan.cycles_per_tick / 16
    assert lateness_us(played.steps(), plan.ramp.intervals(abs(steps)), plan.cycles_per_tick).max() <= 5.5
    played.assert_nothing_lost()


def test_a_trace_of_one_of_four_axes(simulated_controller: Make) -> None:
    played = play(simulated_controller, image([SLOW] * 4), traced(5, 100, -200, 300, 50, axis=2))
    assert offsets(played, SLOW, 2).max() <= 25
    played.assert_nothing_lost()


def test_no_trace_any_more(simulated_controller: Make) -> None:
    """After it is switched off, and after a hello."""

    def work(client: BusyClient) -> None:
        traced(5, 50)(client)
        client.expect_ok(TRACE, bytes([TRACE_OFF, 0, 0]))
        client.notices.clear()
        move_by(50)(client)
        client.wait_until_idle()
        client.expect_ok(TRACE, b"\0\5\0")
        client.expect_ok(HELLO, b"\2")
        move_by(50)(client)

    assert traces_of(play(simulated_controller, image([SLOW]), work)) == []


@pytest.mark.parametrize("rate", [50, 10])
def test_reports_while_moving(simulated_controller: Make, rate: int) -> None:
    """One each 1000 / rate ms, and each with what the motors do at that instant."""

    def work(client: BusyClient) -> None:
        client.expect_ok(REPORT, bytes([rate]))
        move_by(2000, -1000)(client)
        while client.status(0).state or report_of(client.notices[-1]).states != (0, 0, 0, 0):
            pass
        client.expect_ok(REPORT, b"\0")

    played = play(simulated_controller, image([SLOW] * 2), work)
    reports = [report_of(notice) for notice in played.notices if notice[0] == REPORT_NOTICE]
    times = np.unwrap([report.time_ms for report in reports], period=2**16)
    assert np.median(np.diff(times)) == 1000 / rate
    assert np.diff(times).min() >= 1000 / rate - 2
    assert np.diff(times).max() <= 3000 / rate
    for axis, sign in ((0, 1), (1, -1)):
        positions = np.array([report.positions[axis] for report in reports]) * sign
        assert (np.diff(positions) >= 0).all()
        check_positions(positions, times, played.steps(axis) / 16_000)
    moving = [report for report in reports if report.states[:2] == (1, 1)]
    assert all(report.intervals[0] >= SLOW.slew for report in moving)
    assert reports[-1].states == (0, 0, 0, 0)
    assert reports[-1].intervals == (0, 0)


def report_of(notice: bytes) -> Report:
    return Report.unpack(notice[4:])


def check_positions(positions: np.ndarray, times_ms: np.ndarray, steps_ms: np.ndarray) -> None:
    """The reports' clock begins anywhere: with one offset for all of them, the positions are those of the pulses."""
    inside = (positions > 0) & (positions < steps_ms.size)
    earliest = steps_ms[positions[inside] - 1] - times_ms[inside]
    latest = steps_ms[positions[inside]] - times_ms[inside]
    assert earliest.max() <= latest.min() + 2


def test_the_line_carries_both_at_slew_speed(simulated_controller: Make) -> None:
    """50 reports a second, and the trace whose k the controller chooses, with few gaps."""

    def work(client: BusyClient) -> None:
        client.expect_ok(REPORT, b"\x32")
        traced(0, 30_000)(client)
        client.expect_ok(REPORT, b"\0")

    played = play(simulated_controller, image([FAST]), work)
    every = traces_of(played)[0].every
    told = sum(len(trace.values) for trace in traces_of(played))
    assert told >= 0.9 * 30_000 / every
    assert sum(notice[0] == REPORT_NOTICE for notice in played.notices) >= 0.8 * 50 * 30_000 / FAST.speed
    played.assert_nothing_lost()
