"""Stops of somebody else on the line, who knows no more of the protocol than the bytes alone."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress

import pytest

from devices.bench import MOTIONS, Bench, by, run
from stepramp.controllers.contract import AxisCommand
from stepramp.devices.shuttle import Shuttle
from stepramp.devices.view import DeviceState
from stepramp.errors import Refused, StepRampError

STOP, HALT = b"\0\xff\xff\0", b"\0\xfe\xfe\0"
MOST_PLACES = 60


class Somebody:
    """Sends bytes to the controller; its answer goes out to all, with what it sends next."""

    def __init__(self, bench: Bench) -> None:
        self._bench = bench
        self._exchange = bench.witness.exchange
        self._said = b""
        self.moved_after: list[int] = []
        """Requests to move that it was told after it had been told to stop."""

    def send(self, data: bytes) -> None:
        self._said += self._bench.witness.controller.exchange(data)
        self._bench.witness.seen.append("stop of somebody else")

    def exchange(self, sent: bytes) -> bytes:
        # What has been said already comes before what this is answered with.
        said, self._said = self._said, b""
        return said + self._exchange(sent)


@pytest.fixture
def somebody(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> Somebody:
    made = Somebody(bench)
    monkeypatch.setattr(bench.witness, "exchange", made.exchange)
    return made


def begin(bench: Bench) -> None:
    bench.reset()
    bench.device.go_there_and_back(Shuttle(0, 300, times=9, pause_s=0.0), by(300))


def go_on(bench: Bench, time_s: float = 30.0) -> int:
    """Return where it is once there was time enough for many legs."""
    for _ in range(30):
        bench.clock.now_s += time_s / 30
        bench.poll()
    return bench.device.view.axes[0].position_steps


def is_at_rest(bench: Bench) -> bool:
    return bench.device.view.state is DeviceState.READY and bench.device.view.shuttle is None


@pytest.mark.parametrize("data", [STOP, HALT])
@pytest.mark.parametrize("late_s", [0.05, 0.4, 0.9, 1.3])
def test_it_ends_going_to_and_fro(bench: Bench, somebody: Somebody, data: bytes, late_s: float) -> None:
    """Also so late in a leg that this ends where it was to end, or after it."""
    begin(bench)
    stops = bench.device.view.stops
    bench.clock.now_s += late_s
    somebody.send(data)
    bench.witness.seen.clear()
    bench.poll()
    assert bench.device.view.stops > stops
    assert bench.device.view.shuttle is None
    bench.settle()
    there = bench.device.view.axes[0].position_steps
    assert go_on(bench) == there
    assert is_at_rest(bench)
    assert not MOTIONS & set(bench.witness.seen)


def stops_amid(bench: Bench, somebody: Somebody, place: int, act: Callable[[], object]) -> bool:
    """Have somebody stop at a place of what is done; return whether it came to that."""
    bench.places.choose(place, lambda: somebody.send(STOP))
    act()
    came_to_it = bench.places.chosen is None
    bench.places.chosen = None
    return came_to_it


def test_at_each_moment_of_setting_out_on_the_next_leg(bench: Bench, somebody: Somebody) -> None:
    """What was told to move after it is stopped again, at once; and nothing sets out later."""
    for place in range(MOST_PLACES):
        begin(bench)
        bench.clock.now_s += 20.0
        if not stops_amid(bench, somebody, place, bench.poll):
            break
        bench.poll()
        bench.settle()
        there = bench.device.view.axes[0].position_steps
        assert 0 <= there <= 300, place
        assert go_on(bench) == there, place
        assert is_at_rest(bench), place
    else:
        pytest.fail("more places than were looked at")
    assert place > 5, "the leg was set out on in fewer places than there are"


def test_a_motion_in_whose_midst_it_comes_is_refused_and_stopped(bench: Bench, somebody: Somebody) -> None:
    def move() -> None:
        with suppress(StepRampError):
            bench.device.move_by([by(5000)])

    for place in range(MOST_PLACES):
        bench.reset()
        if not stops_amid(bench, somebody, place, move):
            break
        bench.poll()
        bench.settle()
        assert bench.device.view.axes[0].position_steps < 5000, place
    assert place > 3


def test_it_ends_the_lease_of_a_run(bench: Bench, somebody: Somebody) -> None:
    bench.reset()
    run(bench, bench.device.view.stops + 1)
    assert bench.device._runs._leases.speeds
    bench.clock.now_s += 0.1
    somebody.send(STOP)
    bench.poll()
    assert bench.device._runs._leases.speeds == {}
    assert bench.device.view.state is DeviceState.STOPPING


def test_what_is_asked_afterwards_is_carried_out(bench: Bench, somebody: Somebody) -> None:
    bench.reset()
    somebody.send(STOP)
    bench.poll()
    bench.device.move_by([by(50)])
    bench.settle()
    assert bench.device.view.axes[0].position_steps == 50
    somebody.send(STOP)
    with pytest.raises(Refused, match="A stop came first"):
        bench.device.move_to([AxisCommand(0, 0, "position_steps")])
