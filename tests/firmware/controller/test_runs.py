import struct

import pytest

from firmware import protocol as p
from firmware.controller.client import Controller
from firmware.controller.ramps import TWO_AXES
from firmware.protocol import for_axes


def test_a_run_is_not_faster_than_the_ramp_nor_too_slow(controller: Controller) -> None:
    controller.push(TWO_AXES)
    for interval in (1999, -1999, 2**28, -(2**28), -(2**31)):
        assert controller.refused(p.RUN, for_axes({0: interval})) == (p.OUT_OF_RANGE, 0)
    assert controller.refused(p.RUN, for_axes({0: 5000, 1: -2999})) == (p.OUT_OF_RANGE, 1)
    assert controller.status().state == p.IDLE
    controller.ok(p.RUN, for_axes({0: 5000, 1: -3000}))
    controller.run(1000)
    assert controller.status(0).state == controller.status(1).axis_state == p.IN_MOTION
    controller.ok(p.RUN, for_axes({0: 0, 1: 0}))
    controller.run_until_idle()
    positions = [controller.status(axis).position for axis in range(2)]
    assert controller.steps()[:2] == positions
    assert positions[0] > 0 > positions[1]


SILENT = 20_000
"""Rounds, of a byte's time at 115200 baud each: 1.7 s."""


def test_a_run_ends_when_nobody_asks_for_anything(controller: Controller) -> None:
    controller.push(TWO_AXES)
    controller.ok(p.RUN, for_axes({0: 5000, 1: 5000}))
    for _ in range(5):
        controller.run(SILENT // 2)
        assert controller.status(0).axis_state == p.IN_MOTION
    # Axis 1 has got a target to end at, so it needs nobody.
    controller.ok(p.MOVE_TO, for_axes({1: 100_000}))
    at = controller.status(0).position
    controller.run(SILENT)
    assert controller.status(0).axis_state == p.IDLE
    # An interval takes 3.6 rounds here: that many steps are 1.0 to 1.3 s.
    assert 3200 <= controller.status(0).position - at <= 4200
    assert controller.status(1).axis_state == p.IN_MOTION


def test_what_is_refused_changes_nothing_of_that(controller: Controller) -> None:
    controller.push(TWO_AXES)
    controller.ok(p.RUN, for_axes({0: 5000}))
    controller.ok(p.MOVE_TO, for_axes({1: 100_000}))
    assert controller.refused(p.MOVE_BY, for_axes({0: 2**31 - 1})) == (p.OUT_OF_RANGE, 0)
    assert controller.refused(p.RUN, for_axes({1: 1})) == (p.OUT_OF_RANGE, 1)
    controller.run(SILENT)
    assert controller.status(0).axis_state == p.IDLE
    assert controller.status(1).axis_state == p.IN_MOTION


@pytest.mark.parametrize("next_one", [p.ZERO, p.LINE, p.MOVE_BY])
def test_what_comes_after_a_run_needs_nobody(controller: Controller, next_one: int) -> None:
    controller.push(TWO_AXES)
    controller.ok(p.RUN, for_axes({1: 5000}))
    controller.ok(p.STOP, b"")
    controller.run_until_idle()
    bodies = {p.ZERO: struct.pack("<BH", 2, 60_000), p.LINE: b"\2\1" + p.values_of({1: 60_000}),
              p.MOVE_BY: for_axes({1: 60_000})}  # fmt: skip
    controller.ok(next_one, bodies[next_one])
    controller.run(SILENT)
    status = controller.status(1)
    assert (status.axis_state, status.steps_made > 4000) == (p.IN_MOTION, True)
