"""What becomes of steps that came late. How late they come the engine tells: see test_simulator_lateness.py."""

import pytest

from firmware import protocol as p
from firmware.inputs.machine import Machine
from firmware.protocol import for_axes

MOST = 64
"""1.02 ms of the fast clock [256 ticks], which this machine's ramps are not played with: of the slow one 8."""
MOST_SLOW = 8


def late(machine: Machine, by: int) -> None:
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
    late(machine, MOST if fast else MOST_SLOW)
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
