"""What cuts a motion of a Marlin short, at every place where its port's thread gives way, reads or writes.

A stop that was answered is final, and whatever comes in between, whoever talks to it next finds it taking places
(G90), as it was. As in test_stops.py: deterministic, nothing polls unless it is told to.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass

import pytest

from controllers.conftest import Clock
from controllers.marlin.emulator import MarlinEmulator
from devices.bench import Places, by
from devices.line_bench import LineBench, Wire
from devices.motion import PATIENCE_S
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.marlin import conversation, exchange, moves
from stepramp.devices.attachment import Attachment
from stepramp.devices.leases import Lease
from stepramp.devices.registry import Devices
from stepramp.devices.view import DeviceState
from stepramp.errors import StepRampError
from stepramp.link import lines, protocol_sim, serial_port

EXCHANGE_S = 0.002
ANSWERS_AFTER_S = 0.005
REST_S = 3.0
MOST_PLACES = 900


@dataclass
class Bench(LineBench[MarlinEmulator]):
    """A device that is a Marlin."""

    lease: Lease

    @property
    def marlin(self) -> MarlinEmulator:
        return self.wire.emulator

    def rest(self) -> None:
        """Let time go on while it is looked at, as often as a device is."""
        for _ in range(int(REST_S / 0.3)):
            self.wire.clock.now_s += 0.3
            self.poll()

    def reset(self) -> None:
        self.places.chosen = None
        self.device.stop().result(PATIENCE_S)
        self.rest()
        self.device.set_position([AxisCommand(0, 0, "position_steps")])
        self.lease = Lease({0: 1000.0}, 1e6)


@pytest.fixture(params=[False, True], ids=["lines only", "emergency parser"])
def bench(
    request: pytest.FixtureRequest,
    clock: Clock,
    places: Places,
    plug_in: Callable,
    monkeypatch: pytest.MonkeyPatch,
) -> Iterator[Bench]:
    for module in (conversation, exchange, moves, lines):
        monkeypatch.setattr(module, "monotonic", clock)
    monkeypatch.setattr(lines, "GIVE_WAY_S", 0.0)
    monkeypatch.setattr(serial_port, "_READ_SLICE_S", 0.0)
    monkeypatch.setattr(protocol_sim, "LISTEN_S", 0.0)
    monkeypatch.setattr(Attachment, "poll", lambda _: 60.0)
    marlin = MarlinEmulator(clock)
    marlin.has_emergency_parser = request.param
    devices, wire = Devices(), Wire(clock, marlin, EXCHANGE_S)
    device = devices.connect(plug_in(wire), "marlin")
    # It gives way several times before a line that was sent is carried out, and before that is answered.
    marlin.answers_after_s = ANSWERS_AFTER_S
    yield Bench(devices, device, wire, places, Lease({0: 1000.0}, 1e6))
    devices.close()


def move(bench: Bench) -> None:
    bench.device.move_by([by(8000)], bench.devices.order.next())


def jog(bench: Bench) -> None:
    bench.device.run([AxisCommand(0, 1000.0, "speed_steps_per_s")], bench.lease)


def stop(bench: Bench) -> None:
    bench.device.stop()


def halt(bench: Bench) -> None:
    bench.device.halt()


def let_go(bench: Bench) -> None:
    bench.device.end_run(bench.lease)


def in_vain(bench: Bench) -> None:
    """Let the lease run out, of which nobody tells the port's thread."""
    bench.lease.end()


@pytest.mark.parametrize(
    ("begin", "cut"),
    [(move, stop), (move, halt), (jog, stop), (jog, let_go), (jog, in_vain)],
    ids=lambda each: each.__name__,
)
def test_what_is_cut_short_leaves_no_marlin_relative(
    bench: Bench, begin: Callable[[Bench], None], cut: Callable[[Bench], None]
) -> None:
    place = 0
    while place < MOST_PLACES and cut_short_at(bench, place, begin, cut):
        place += 1
    assert 20 <= place < MOST_PLACES


def cut_short_at(bench: Bench, place: int, begin: Callable[[Bench], None], cut: Callable[[Bench], None]) -> bool:
    """Cut a motion short at a place; return whether it came to that."""
    bench.reset()
    bench.places.choose(place, lambda: cut(bench))
    with suppress(StepRampError):
        begin(bench)
    came_to_it = bench.places.chosen is None
    bench.places.chosen = None
    if not came_to_it:
        return False
    bench.rest()
    steps = bench.marlin.steps
    bench.rest()
    assert (bench.marlin.steps, bench.marlin.is_moving) == (steps, False), place
    assert not bench.marlin._is_relative, (place, bench.marlin.lines[-8:])
    assert bench.device.view.state is DeviceState.READY, place
    assert bench.device.view.position_steps == bench.marlin.position[0] + offset(bench), place
    return True


def offset(bench: Bench) -> int:
    controller = bench.device._attachment._contact.controller
    return controller._places._offsets[0]  # type: ignore[attr-defined,no-any-return]
