"""Homing: a fast approach, back off, a slow approach; the switch is at position 0 then, to the step."""

import struct
from collections.abc import Mapping

import pytest

from firmware import protocol as p
from firmware.controller.ramps import FOUR_AXES
from firmware.inputs.machine import LOW_INPUT, STOP_INPUT, Machine
from firmware.protocol import InputSettings, Settings, for_axes, values_of

SLOW = 160_000
"""100 steps/s: here all ticks are those of the fast clock."""
FAST = 3000


def home(intervals: Mapping[int, int], *, slow: int = SLOW, back: int = 20) -> bytes:
    mask = sum(1 << axis for axis in intervals)
    return bytes([mask]) + struct.pack("<IH", slow, back) + values_of(intervals)


@pytest.mark.parametrize("at_once", [0, p.AT_ONCE])
@pytest.mark.parametrize("start", [0, 1, 37, 450])
def test_the_switch_is_at_position_0(machine: Machine, at_once: int, start: int) -> None:
    machine.give(InputSettings(roles={LOW_INPUT: p.LOW_LIMIT | at_once}))
    machine.add_switch(LOW_INPUT, 0, -40, is_backward=True)
    machine.ok(p.MOVE_TO, for_axes({0: start}))
    machine.go_to_rest()
    before = machine.steps()[0]
    machine.ok(p.HOME, home({0: -FAST}))
    assert machine.inputs().homing == 1
    status = machine.go_to_rest()
    # The switch is inactive at -39 and active at -40.
    assert machine.steps()[0] - status.position == -39
    assert machine.steps()[0] != before
    assert machine.inputs().known == 1
    assert -3 <= status.position <= 0


def test_it_comes_to_the_same_step_each_time(machine: Machine) -> None:
    machine.add_switch(LOW_INPUT, 0, -40, is_backward=True)
    places = []
    for way in range(12):
        machine.ok(p.HOME, home({0: -FAST}))
        status = machine.go_to_rest()
        places.append(machine.steps()[0] - status.position)
        machine.ok(p.MOVE_BY, for_axes({0: 100 + 61 * way}))
        machine.go_to_rest()
        machine.pass_ms(17 * way)
    assert set(places) == {-39}


def test_at_its_switch_it_begins_with_the_way_back(machine: Machine) -> None:
    machine.add_switch(LOW_INPUT, 0, 10, is_backward=True)
    machine.pass_ms(20)
    machine.ok(p.HOME, home({0: -FAST}))
    status = machine.go_to_rest()
    assert machine.steps()[0] - status.position == 11


def test_several_axes_home_each_by_itself(machine: Machine) -> None:
    machine.push(FOUR_AXES)
    machine.give(InputSettings(roles={5: p.HIGH_LIMIT + 1, 6: p.LOW_LIMIT, 7: p.LOW_LIMIT + 2, 8: p.LOW_LIMIT + 3}))
    machine.add_switch(6, 0, -700, is_backward=True)
    machine.add_switch(5, 1, 90, is_backward=False)
    machine.add_switch(7, 2, -3, is_backward=True)
    machine.ok(p.SET_POSITION, for_axes({3: 5}))
    machine.ok(p.HOME, home({0: -FAST, 1: FAST, 2: -FAST}, slow=80_000))
    assert machine.inputs().homing == 7
    assert machine.refused(p.MOVE_BY, for_axes({1: 5})) == (p.MOVING, 0)
    machine.ok(p.MOVE_BY, for_axes({3: 5}))
    machine.go_to_rest()
    steps = machine.steps()
    assert [steps[axis] - machine.status(axis).position for axis in range(3)] == [-699, 89, -2]
    assert machine.inputs().known == 15


@pytest.mark.parametrize("after_ms", [1, 20, 60, 150, 300, 500, 900, 1100])
@pytest.mark.parametrize("kind", [p.STOP, p.HALT, STOP_INPUT])
def test_whatever_stops_it_ends_it(machine: Machine, after_ms: int, kind: int) -> None:
    machine.add_switch(LOW_INPUT, 0, -40, is_backward=True)
    machine.ok(p.HOME, home({0: -FAST}, slow=5 * SLOW))
    machine.pass_ms(after_ms)
    assert machine.inputs().homing == 1
    if kind == STOP_INPUT:
        machine.pull_down(STOP_INPUT)
    else:
        machine.ok(kind)
    machine.go_to_rest()
    there = machine.steps()[0]
    machine.go_on_ms(2000)
    assert machine.steps()[0] == there
    assert (machine.inputs().homing, machine.inputs().known) == (0, 0)


@pytest.mark.parametrize("after_ms", [1, 50, 300, 600, 900])
def test_silence_ends_it(machine: Machine, after_ms: int) -> None:
    machine.add_switch(LOW_INPUT, 0, -40, is_backward=True)
    machine.ok(p.HOME, home({0: -FAST}, slow=10 * SLOW))
    machine.pass_ms(after_ms)
    assert machine.inputs().homing == 1
    machine.pass_ms(4000)
    assert (machine.inputs().homing, machine.inputs().known) == (0, 0)
    there = machine.steps()[0]
    machine.pass_ms(500)
    assert machine.steps()[0] == there


@pytest.mark.parametrize("is_closed_at_first", [True, False])
def test_from_a_switch_that_stays_closed_it_goes_so_far_and_no_farther(
    machine: Machine, is_closed_at_first: bool
) -> None:
    if is_closed_at_first:
        machine.pull_down(LOW_INPUT)
        machine.pass_ms(20)
    machine.ok(p.HOME, home({0: -FAST}, slow=8000, back=3))
    machine.pass_ms(300)
    machine.pull_down(LOW_INPUT)
    machine.go_to_rest()
    assert 64 * 3 <= machine.steps()[0] <= 64 * 3 + 50
    assert (machine.inputs().homing, machine.inputs().known) == (0, 0)


def test_to_a_switch_that_stays_open_it_comes_back_so_far_and_no_farther(machine: Machine) -> None:
    machine.pull_down(LOW_INPUT)
    machine.pass_ms(20)
    machine.ok(p.HOME, home({0: -FAST}, slow=8000, back=5))
    machine.pass_ms(100)
    machine.pull_down()
    machine.go_to_rest()
    assert -64 * 5 - 50 <= machine.steps()[0] <= -64 * 5
    assert (machine.inputs().homing, machine.inputs().known) == (0, 0)


def test_another_axis_that_takes_the_time_for_steps_leaves_it_under_control(machine: Machine) -> None:
    """The second one goes faster than both could at once, which is no matter while the first one is slow."""
    fast = p.Ramp([(4000, 200, -19)], 130, [(4000, 200, -19)])
    machine.push(fast.image(2, fast=True))
    machine.give(InputSettings(roles={LOW_INPUT: p.LOW_LIMIT}))
    machine.add_switch(LOW_INPUT, 0, -700, is_backward=True)
    machine.ok(p.HOME, home({0: -FAST}, slow=8000))
    machine.ok(p.RUN, for_axes({1: 250}))
    for _ in range(15):
        machine.go_on_ms(200)
    assert (machine.inputs().homing, machine.inputs().known & 1) == (0, 1)
    assert -700 <= machine.steps()[0] - machine.status().position <= -698  # two steps between two looks


def test_between_its_stages_all_that_disturbs_it_is_refused(machine: Machine) -> None:
    """An axis is at rest there for a moment; so it is asked all the time."""
    machine.push(p.Ramp([(2000, 50, -20)], 1000, []).image(2))
    roles = InputSettings(roles={LOW_INPUT: p.LOW_LIMIT, 7: p.LOW_LIMIT + 1})
    machine.give(roles)
    machine.add_switch(LOW_INPUT, 0, -300, is_backward=True)
    disturbances = [
        (p.HOME, home({1: -FAST}, slow=40_000)),
        (p.WRITE_SETTINGS, Settings().packed() + roles.packed()),
        (p.ROLL_BACK, b""),
        (p.LINE, bytes([2, 1]) + values_of({1: 5})),
    ]
    machine.ok(p.HOME, home({0: -FAST}, slow=40_000, back=100))
    while machine.inputs().homing == 1:
        for kind, body in disturbances:
            reply = machine.send(kind, body)
            assert reply[0] == p.MOVING or machine.inputs().homing == 0, hex(kind)
    machine.go_to_rest()


def test_what_it_can_not_do_is_refused(machine: Machine) -> None:
    assert machine.refused(p.HOME, home({0: FAST, 1: FAST})) == (p.OUT_OF_RANGE, 3)
    machine.give(InputSettings(roles={LOW_INPUT: p.LOW_LIMIT}))
    assert machine.refused(p.HOME, home({0: FAST})) == (p.OUT_OF_RANGE, 0)
    assert machine.refused(p.HOME, home({0: -1999})) == (p.OUT_OF_RANGE, 0)
    assert machine.refused(p.HOME, home({0: -FAST}, slow=1999)) == (p.OUT_OF_RANGE, 0)
    assert machine.refused(p.HOME, home({0: -FAST}, slow=0)) == (p.OUT_OF_RANGE, 0)
    assert machine.refused(p.HOME, home({0: -FAST}, back=0)) == (p.OUT_OF_RANGE, 0)
    assert machine.refused(p.HOME, home({0: 0})) == (p.OUT_OF_RANGE, 0)
    assert machine.refused(p.HOME, home({})) == (p.OUT_OF_RANGE, 0)
    assert machine.refused(p.HOME, home({0: -FAST})[:-1]) == (p.BAD_LENGTH, 10)
    machine.ok(p.RUN, for_axes({0: FAST}))
    assert machine.refused(p.HOME, home({0: -FAST})) == (p.MOVING, 0)
