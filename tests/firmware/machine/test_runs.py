import pytest

from firmware.host import Host
from firmware.machine.obedience import assert_without_a_stall
from firmware.machine.ramps import QUICK, coarse_slope
from firmware.motion import OK, OUT_OF_RANGE, Machine, StoredRamp, image_of


@pytest.mark.parametrize("round_ticks", [8_000, 16_000, 32_000])
def test_a_run_that_becomes_slower_does_not_wait(host: Host, round_ticks: int) -> None:
    side = coarse_slope(120_000, 600_000, 40)
    ramp = StoredRamp(side, 133, side)
    machine = Machine(host, image_of(ramp, fast=True), round_ticks=round_ticks)
    before = machine.report().starved
    for interval in (133, 2000):
        machine.ask("run", 1, interval)
        machine.do("wait", 400 * 16_000)
        assert machine.report().interval == interval
    assert machine.report().starved == before
    assert_without_a_stall(machine.steps().intervals, ramp)
    machine.do("halt", 1)


def test_running(host: Host) -> None:
    """Up to the speed, slower along the ramp down, faster along the ramp up, back through rest, and a stop by 0."""
    machine = Machine(host, image_of(QUICK))
    for interval in (2500, 4000, 2200):
        assert machine.ask("run", 1, interval) == (OK, 0)
        machine.do("wait", 100_000)
        assert machine.report().interval == interval
        assert machine.report().state == 1
    made = machine.steps()
    changes = [made.intervals[0]] + [b for a, b in zip(made.intervals, made.intervals[1:], strict=False) if a != b]
    up, down = QUICK.up, QUICK.down[::-1]
    slowed = [i for i in down if 2500 < i < 4000]
    assert changes == [*(i for i in up if i >= 2500), 2500, *slowed, 4000, *(i for i in up if 2200 <= i < 4000), 2200]
    machine.ask("run", 1, -3000)
    machine.do("wait", 200_000)
    assert machine.report().interval == 3000
    machine.ask("run", 1, 0)
    machine.rest()
    assert [steps > 0 for steps, _ in machine.steps().moves] == [True, False]


def test_run_is_not_faster_than_the_ramp(host: Host) -> None:
    machine = Machine(host, image_of(QUICK))
    assert machine.ask("run", 1, QUICK.slew - 1) == (OUT_OF_RANGE, 0)
    assert machine.ask("run", 1, -(QUICK.slew - 1)) == (OUT_OF_RANGE, 0)
    assert machine.ask("run", 1, 2**28) == (OUT_OF_RANGE, 0)
    assert machine.ask("run", 1, 2**28 - 1) == (OK, 0)
