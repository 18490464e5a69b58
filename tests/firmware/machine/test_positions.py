import pytest

from firmware.host import Host
from firmware.machine.ramps import QUICK
from firmware.motion import OK, Machine, image_of


def test_positions_up_to_the_limits(host: Host) -> None:
    machine = Machine(host, image_of(QUICK))
    machine.do("position", 1, 2**31 - 11)
    machine.move(2**31 - 1)
    machine.rest()
    assert machine.report().position == 2**31 - 1
    assert machine.steps().travel == 10


@pytest.mark.parametrize("direction", [1, -1])
def test_a_run_goes_on_past_the_last_position(host: Host, direction: int) -> None:
    """Positions count modulo 2³²; a stop and a move count from there."""
    machine = Machine(host, image_of(QUICK))
    last = 2**31 - 1 if direction > 0 else -(2**31)
    for before in (0, 5, 60):
        machine.do("position", 1, last - direction * before)
        machine.all_steps()
        machine.ask("run", 1, direction * 2500)
        machine.do("wait", 300_000)
        assert machine.report().state == 1
        machine.do("stop", 1)
        target = machine.report().target
        machine.rest()
        made = machine.steps().travel
        assert abs(made) > 80
        assert machine.report().position == target == last - direction * before + made - direction * 2**32
        assert machine.move(target - direction * 7) == (OK, 0)
        machine.rest()
        assert machine.steps().travel == -direction * 7


@pytest.mark.parametrize("before", range(0, 130, 7))
def test_a_stop_at_the_last_position_ends_where_it_says(host: Host, before: int) -> None:
    machine = Machine(host, image_of(QUICK))
    machine.do("position", 1, 2**31 - 1 - before)
    machine.ask("run", 1, 2000)
    machine.do("wait", 130_000)
    machine.do("stop", 1)
    target = machine.report().target
    machine.rest()
    assert machine.report().position == target
    assert (machine.steps().travel + 2**31 - 1 - before - target) % 2**32 == 0


def test_zero_runs_back_to_zero(host: Host) -> None:
    machine = Machine(host, image_of(QUICK))
    assert machine.ask("zero", 1, 945) == (OK, 0)
    machine.rest()
    assert machine.steps().travel == -945
    assert machine.report().position == 0
