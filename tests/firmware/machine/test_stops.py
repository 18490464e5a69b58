import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from firmware.host import Host
from firmware.machine.obedience import assert_obeys
from firmware.machine.orders import give_order, orders
from firmware.machine.ramps import QUICK, RAMPS, SHARP, coarse_slope
from firmware.motion import SLOW_HZ, Machine, StoredRamp, image_of


@given(wait=st.integers(0, 120_000))
def test_stop_slows_down_along_the_ramp(host: Host, wait: int) -> None:
    machine = Machine(host, image_of(QUICK))
    machine.move(5000)
    machine.do("wait", wait)
    machine.do("stop", 1)
    machine.rest()
    report, made = machine.report(), machine.steps()
    assert report.state == 0
    assert report.position == report.target == made.travel
    assert_obeys(made, QUICK, QUICK.slew)
    if len(made.times) > 1:
        assert made.intervals[-1] >= sorted(QUICK.down)[-2] or made.travel <= 2


@given(ramp=st.sampled_from(RAMPS), orders=orders, wait=st.integers(0, 60_000), more=st.integers(-60, 60))
@example(ramp=QUICK, orders=[("run", 100, 30_000)], wait=0, more=5)
@example(ramp=SHARP, orders=[("move", 200, 100)], wait=0, more=-5)
@example(ramp=QUICK, orders=[("move", 200, 70_000), ("move", -10, 100)], wait=0, more=20)
def test_after_a_stop_the_target_is_where_it_comes_to_rest(
    host: Host, ramp: StoredRamp, orders: list[tuple[str, int, int]], wait: int, more: int
) -> None:
    """From the stop on, whatever came before; and what is asked for then may count from there."""
    machine = Machine(host, image_of(ramp))
    for order, value, pause in orders:
        give_order(machine, order, value, ramp)
        machine.do("wait", pause)
    machine.do("stop", 1)
    target = machine.report().target
    machine.do("wait", wait)
    assert machine.report().target == target
    machine.move(target + more)
    machine.rest()
    assert machine.report().position == target + more
    machine.do("stop", 1)
    give_order(machine, *orders[-1][:2], ramp)
    machine.do("wait", orders[-1][2])
    machine.do("stop", 1)
    target = machine.report().target
    machine.rest()
    assert machine.report().position == target == machine.steps().travel


def test_after_a_stop_the_target_is_known_also_on_long_lists(host: Host) -> None:
    """Right after a quick start, when the list of the ramp down has hardly been read."""
    ramp = StoredRamp(coarse_slope(20_000, 2_000_000, 4), 800, coarse_slope(20_000, 50_000, 80))
    machine = Machine(host, image_of(ramp, fast=True), round_ticks=16_000)
    for wait_ms in range(1, 60):
        machine.ask("run", 1, 800)
        machine.do("wait", wait_ms * 16_000)
        machine.do("stop", 1)
        target = machine.report().target
        machine.rest()
        assert machine.report().position == target


@given(wait=st.integers(0, 200_000))
def test_halt_knows_every_step(host: Host, wait: int) -> None:
    machine = Machine(host, image_of(QUICK))
    machine.move(-300)
    machine.do("wait", wait)
    machine.do("halt", 1)
    report = machine.report()
    machine.do("wait", 50_000)
    assert report.position == machine.steps().travel
    assert (report.state, report.target, report.interval) == (0, report.position, 0)
    machine.move(7)
    machine.rest()
    assert machine.steps().travel == 7 - report.position


@pytest.mark.parametrize("order", ["stop 1", "run 1 0"])
def test_what_has_not_set_out_when_it_is_stopped_makes_no_step(host: Host, order: str) -> None:
    """The move is queued, but waits until the motors, which are enabled for it, hold."""
    lead_ms = 100
    settings = bytes([0, 0, 0, 0, 0, 0, *(30).to_bytes(2, "little"), *lead_ms.to_bytes(2, "little"), 0, 0])
    machine = Machine(host, image_of(QUICK), settings)
    machine.do("wait", SLOW_HZ)  # until the motors are let go of
    machine.move(500)
    machine.do("wait", SLOW_HZ * lead_ms // 2000)
    host.ask(*order.split())
    assert (machine.report().position, machine.report().target) == (0, 0)
    machine.do("wait", SLOW_HZ * lead_ms // 500)
    assert machine.report().state == 0
    assert machine.steps().times == []
    machine.move(3)
    machine.rest()
    assert machine.steps().intervals == QUICK.move(3)[:-1]


def test_a_stop_while_the_direction_settles_lets_no_step_be_made(host: Host) -> None:
    """The engine has started, but pulse 1 comes only then; also where the motor turns round."""
    settle_us = 15_000
    settings = bytes([0, 0, 0, 0, 0, 0, *settle_us.to_bytes(2, "little"), 0, 0, 0xFF, 0xFF])
    machine = Machine(host, image_of(QUICK), settings)
    for target in (300, 0):
        position = machine.report().position
        machine.move(target)
        machine.do("wait", SLOW_HZ * settle_us // 2_000_000)
        machine.do("stop", 1)
        assert (machine.report().position, machine.report().target) == (position, position)
        machine.rest()
        assert machine.steps().times == []
        machine.move(target)
        machine.rest()
        machine.steps()
        assert machine.report().position == target


@pytest.mark.parametrize("wait", range(0, 80_000, 1000))
def test_a_stop_where_the_motor_turns_round_lets_it_rest(host: Host, wait: int) -> None:
    """Whether it comes before the rest, in it, or after it: no motor that has come to rest sets out again."""
    settings = bytes([0, 0, 0, 0, 0, 0, *(15_000).to_bytes(2, "little"), 0, 0, 0xFF, 0xFF])
    machine = Machine(host, image_of(QUICK), settings)
    machine.move(3)
    machine.do("wait", 33_000)
    machine.move(-300)
    machine.do("wait", wait)
    machine.do("stop", 1)
    way = machine.report().position
    target = machine.report().target
    machine.rest()
    made = machine.steps()
    assert machine.report().position == target == made.travel
    assert target <= way or not any(made.backward)
