"""What becomes of steps that came late. How late they come the engine tells: see test_simulator_lateness.py."""

import pytest

from firmware import protocol as p
from firmware.inputs.machine import Machine
from firmware.protocol import for_axes

MOST = 64
"""1.02 ms of the fast clock [256 ticks], which this machine's ramps are not played with: of the slow one 8."""
MOST_SLOW = 8


def late(machine: Machine, by: int) -> None:
    """Have the axis that runs be late by so much more."""
    machine.driver.ask("late", by)


@pytest.mark.parametrize("fast", [False, True])
def test_late_by_more_than_a_millisecond_it_halts_all(machine: Machine, *, fast: bool) -> None:
    machine.push(p.Ramp([(20_000, 10, -50)], 15_000, []).image(2, fast=fast))
    machine.ok(p.SET_POSITION, for_axes({0: 0, 1: 0}))
    machine.ok(p.RUN, for_axes({0: 15_000}))
    machine.pass_ms(100)
    late(machine, (MOST if fast else MOST_SLOW) - 1)
    machine.pass_ms(50)
    assert machine.inputs().stopped_by == 0
    late(machine, 1)
    machine.pass_ms(5)
    there = machine.steps()
    inputs = machine.inputs()
    assert (inputs.stopped_by, inputs.known, machine.status().state) == (p.BY_LATENESS, 0, p.IDLE)
    for kind, body in ((p.RUN, for_axes({1: 15_000})), (p.MOVE_BY, for_axes({0: 1}))):
        assert machine.refused(kind, body) == (p.STOPPED, 0)
    assert machine.steps() == there
    # It has been forgotten with the motion, and acknowledged it stays so.
    machine.ok(p.ACKNOWLEDGE)
    machine.ok(p.MOVE_BY, for_axes({0: 10}))
    machine.go_to_rest()
    assert machine.inputs().stopped_by == 0
    assert machine.steps()[0] == there[0] + 10


def test_lateness_of_a_motion_ends_with_it(machine: Machine) -> None:
    for _ in range(5):
        machine.ok(p.MOVE_BY, for_axes({0: 10}))
        machine.pass_ms(10)
        late(machine, MOST_SLOW - 1)
        machine.go_to_rest()
    assert machine.inputs().stopped_by == 0


QUICK = p.Ramp([(4000, 40, -70)], 1000, [(4000, 40, -70)])
SEGMENT = 60
"""Steps in what is queued at once, at most."""


def steps_of_a_stop(machine: Machine) -> int:
    before = machine.steps()[0]
    machine.ok(p.STOP)
    machine.go_to_rest()
    return machine.steps()[0] - before


def test_of_one_axis_alone_it_is_forgotten_after_a_second(machine: Machine) -> None:
    """However long that goes on, no more is queued for it than at first, and no less."""
    machine.push(QUICK.image(2, fast=True))
    machine.ok(p.RUN, for_axes({0: 1000}))
    machine.go_on_ms(1000)
    at_first = steps_of_a_stop(machine)
    machine.ok(p.RUN, for_axes({0: 1000}))
    for _ in range(60):
        machine.go_on_ms(1100)
        late(machine, MOST - 1)
    status = machine.status()
    assert (machine.inputs().stopped_by, status.starved) == (0, 0)
    assert status.state != p.IDLE
    assert abs(steps_of_a_stop(machine) - at_first) <= SEGMENT
    assert machine.status().starved == 0


def test_of_several_it_is_kept_until_they_rest(machine: Machine) -> None:
    machine.push(QUICK.image(2, fast=True))
    machine.ok(p.RUN, for_axes({0: 1000, 1: 1000}))
    machine.go_on_ms(500)
    late(machine, MOST - 2)
    machine.go_on_ms(2200)
    machine.ok(p.STOP, b"\2")
    machine.go_on_ms(2200)
    # What comes to it while the other one moves alone is forgotten, and it is not.
    for _ in range(3):
        late(machine, 1)
        machine.go_on_ms(2200)
        assert machine.inputs().stopped_by == 0
    late(machine, 2)
    machine.pass_ms(5)
    assert machine.inputs().stopped_by == p.BY_LATENESS
