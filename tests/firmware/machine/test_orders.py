import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from firmware.host import Host
from firmware.machine.obedience import assert_obeys, assert_without_a_stall
from firmware.machine.orders import give_order, orders
from firmware.machine.ramps import LONG, QUICK, RAMPS, SHARP
from firmware.motion import Machine, Steps, StoredRamp, image_of


@given(ramp=st.sampled_from(RAMPS), orders=orders, last=st.integers(-300, 300))
@example(ramp=RAMPS[1], orders=[("move", 2, 101)], last=4)
@example(ramp=QUICK, orders=[("move", 200, 20_000)], last=30)
@example(ramp=QUICK, orders=[("move", 200, 20_000), ("move", 10, 3000)], last=-100)
@example(ramp=QUICK, orders=[("run", 100, 30_000), ("run", 20, 30_000), ("run", -50, 30_000)], last=0)
@example(ramp=RAMPS[2], orders=[("run", 100, 30_000), ("run", 20, 30_000), ("run", -50, 30_000)], last=0)
def test_orders_in_flight(host: Host, ramp: StoredRamp, orders: list[tuple[str, int, int]], last: int) -> None:
    """Whatever is asked, and when: the motor obeys its ramp, reverses through rest, and no step is lost."""
    machine = Machine(host, image_of(ramp))
    halted = False
    for order, value, wait in orders:
        give_order(machine, order, value, ramp)
        halted = halted or order == "halt"
        machine.do("wait", wait)
    machine.move(last)
    machine.rest()
    made = machine.steps()
    assert made.travel == last == machine.report().position
    assert machine.report().starved == 0
    if not halted:
        assert_obeys(made, ramp, ramp.slew + 20 * 200)


@given(target=st.integers(-400, 400), wait=st.integers(0, 200_000))
@example(target=100, wait=0)
@example(target=-1, wait=20_000)
def test_a_target_passed_is_come_back_to(host: Host, target: int, wait: int) -> None:
    machine = Machine(host, image_of(SHARP))
    machine.move(300)
    machine.do("wait", wait)
    machine.move(target)
    machine.rest()
    made = machine.steps()
    assert made.travel == target
    assert_obeys(made, SHARP, SHARP.slew)
    assert len(made.moves) <= 3


def test_a_farther_target_is_gone_to_without_a_stop(host: Host) -> None:
    """Asked while slowing down: it speeds up again."""
    machine = Machine(host, image_of(QUICK))
    machine.move(100)
    while not machine.report().position > 85:
        machine.do("wait", 200)
    machine.move(400)
    machine.rest()
    made = machine.steps()
    assert len(made.moves) == 1
    assert max(made.intervals[60:300]) < QUICK.up[0]
    assert made.travel == 400


@pytest.mark.parametrize("round_ticks", [8_000, 16_000, 32_000])
@pytest.mark.parametrize("at_ms", range(210, 400, 10))
def test_a_move_that_is_extended_while_it_slows_down_does_not_wait(host: Host, at_ms: int, round_ticks: int) -> None:
    """The place on the ramp up is near when it is wanted, also when the main loop takes 2 ms for a round."""
    machine = Machine(host, image_of(LONG, fast=True), round_ticks=round_ticks)
    before = machine.report().starved
    machine.move(4200)
    machine.do("wait", at_ms * 16_000)
    machine.move(4220)
    machine.rest()
    made = machine.steps()
    assert machine.report().starved == before
    assert made.travel == 4220
    assert_without_a_stall(made.intervals, LONG)


def there_and_on(machine: Machine, wait: int, direction: int) -> Steps:
    """Move 3 steps, and 3 more after so long, while the silence after the first ones passes; return all of them."""
    machine.do("position", 1, 0)
    machine.move(3)
    machine.do("wait", wait)
    machine.move(3 + 3 * direction)
    machine.rest()
    return machine.steps()


@pytest.mark.parametrize("direction", [1, -1])
def test_a_move_right_after_another_begins_as_planned(host: Host, direction: int) -> None:
    """Whenever it is asked for, and though what is queued takes its time, nothing waits but the motor at rest."""
    machine = Machine(host, image_of(QUICK))
    machine.do("put", 600)
    planned, before = QUICK.move(3)[:-1], machine.report().starved
    for wait in range(24_800, 26_400, 50):
        intervals = there_and_on(machine, wait, direction).intervals
        assert intervals[:2] == planned == intervals[3:]
        assert machine.report().starved == before
