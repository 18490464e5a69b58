import struct

import pytest

from firmware import protocol as p
from firmware.controller.client import Controller
from firmware.controller.lengths import FOR_AXES
from firmware.controller.limits import LIMITS
from firmware.controller.ramps import FOUR_AXES, RAMP, TWO_AXES
from firmware.protocol import Ramp, for_axes


def test_masks_name_axes_that_the_ramp_has(controller: Controller) -> None:
    for kind, length in FOR_AXES.items():
        assert controller.refused(kind, (b"\1" + bytes(length))[:length]) == (p.NO_RAMP, 0)
    controller.push(TWO_AXES)
    for kind in set(FOR_AXES) - {p.ZERO}:
        extra = int(kind == p.LINE)
        for mask in (0, 4, 5, 128, 255):
            body = bytes([mask]) + bytes(extra + 4 * mask.bit_count())
            assert controller.refused(kind, body) == (p.OUT_OF_RANGE, mask)
    assert controller.refused(p.ZERO, b"\4\1\0") == (p.OUT_OF_RANGE, 4)


def test_values_go_to_their_axes(controller: Controller) -> None:
    controller.push(FOUR_AXES)
    assert controller.ok(p.MOVE_BY, for_axes({1: 7, 3: -4})) == struct.pack("<ii", 7, -4)
    controller.run_until_idle()
    assert [controller.status(axis).position for axis in range(4)] == [0, 7, 0, -4]
    assert controller.ok(p.MOVE_TO, for_axes({0: 1, 1: 2, 2: -3, 3: 4})) == struct.pack("<4i", 1, 2, -3, 4)
    controller.run_until_idle()
    assert controller.steps() == [controller.status(axis).position for axis in range(4)] == [1, 2, -3, 4]
    assert controller.refused(p.STATUS, b"\4") == (p.OUT_OF_RANGE, 4)


@pytest.mark.parametrize("target", [-(2**31), 2**31 - 1])
def test_the_farthest_targets(controller: Controller, target: int) -> None:
    controller.push(RAMP)
    assert controller.ok(p.MOVE_TO, for_axes({0: target})) == struct.pack("<i", target)
    status = controller.status()
    assert (status.state, status.axis_state, status.target) == (p.IN_MOTION, p.IN_MOTION, target)
    controller.ok(p.HALT)
    assert controller.status().state == p.IDLE


def test_a_target_beyond_32_bits_is_refused(controller: Controller) -> None:
    controller.push(TWO_AXES)
    controller.ok(p.SET_POSITION, for_axes({1: 2**31 - 5}))
    assert controller.refused(p.MOVE_BY, for_axes({0: 5, 1: 5})) == (p.OUT_OF_RANGE, 1)
    assert controller.refused(p.LINE, b"\3\0" + p.values_of({0: 5, 1: 5})) == (p.OUT_OF_RANGE, 1)
    controller.ok(p.SET_POSITION, for_axes({0: -(2**31), 1: 0}))
    assert controller.refused(p.MOVE_BY, for_axes({0: -1})) == (p.OUT_OF_RANGE, 0)
    assert controller.status().state == p.IDLE
    assert controller.ok(p.MOVE_BY, for_axes({0: 2**31 - 1})) == struct.pack("<i", -1)


def test_positions_are_set_and_zeroed(controller: Controller) -> None:
    controller.push(TWO_AXES)
    controller.ok(p.SET_POSITION, for_axes({0: -70, 1: 1234}))
    assert (controller.status(0).position, controller.status(1).position) == (-70, 1234)
    controller.ok(p.ZERO, struct.pack("<BH", 2, 30))
    assert controller.status(1).state == p.IN_MOTION
    controller.run_until_idle()
    assert (controller.status(0).position, controller.status(1).position) == (-70, 0)
    assert controller.steps() == [0, -30, 0, 0]


def test_a_line_needs_an_axis_whose_ramp_it_plays(controller: Controller) -> None:
    controller.push(TWO_AXES)
    assert controller.refused(p.LINE, b"\3\2" + p.values_of({0: 5, 1: 5})) == (p.OUT_OF_RANGE, 2)
    assert controller.ok(p.LINE, b"\1\1" + p.values_of({0: 5})) == struct.pack("<i", 5)
    assert controller.run_until_idle().position == 5


def test_what_is_too_fast_together_is_refused(controller: Controller) -> None:
    fast = LIMITS.shortest[0] + 40
    controller.push(Ramp([(4000, 20, -150)], fast, []).image(2, fast=True))
    status, share = controller.refused(p.MOVE_BY, for_axes({0: 100, 1: 100}))
    assert (status, share > 100) == (p.TOO_FAST, True)
    assert controller.status().state == p.IDLE
    controller.ok(p.MOVE_BY, for_axes({0: 100}))
