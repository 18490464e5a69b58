"""A stop of a grbl that was answered is final: at every place where its port's thread gives way, reads or writes.

As in test_stops.py: deterministic, nothing polls unless it is told to. Time goes on with what is exchanged.
"""

from __future__ import annotations

import re
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field

import pytest

from controllers.conftest import Clock
from controllers.fluidnc.emulator import FluidNcEmulator
from controllers.grbl.emulator import GrblEmulator
from devices.bench import Places, by, worker_of
from devices.line_bench import LineBench, Wire
from devices.motion import PATIENCE_S
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.grbl import conversation, moves
from stepramp.devices.attachment import Attachment
from stepramp.devices.leases import Lease
from stepramp.devices.registry import Devices
from stepramp.devices.shuttle import Shuttle
from stepramp.devices.soft_limits import Span
from stepramp.devices.view import DeviceState
from stepramp.errors import Refused, StepRampError
from stepramp.link import lines, protocol_sim, serial_port

EXCHANGE_S = 0.03
REST_S = 2.0
MOST_PLACES = 400


@dataclass
class Bench(LineBench[GrblEmulator]):
    """A device that is a grbl, or one that is spoken to as such."""

    jogs_at_answer: int = 0
    answered: threading.Event = field(default_factory=threading.Event)

    @property
    def grbl(self) -> GrblEmulator:
        return self.wire.emulator

    @property
    def jogs(self) -> int:
        return sum(line.startswith("$J=") for line in self.grbl.lines)

    def pass_time(self, time_s: float) -> None:
        self.wire.clock.now_s += time_s
        self.grbl.exchange(b"")

    def look(self) -> None:
        worker_of(self.device).call(self.device._attachment._watch.refresh)

    def reset(self) -> None:
        """Rest at 0, unlocked."""
        self.places.chosen = None
        self.device.stop().result(PATIENCE_S)
        self.pass_time(REST_S)
        self.look()
        self.device.set_position([AxisCommand(axis, 0, "position_steps") for axis in range(3)])
        self.answered.clear()


@pytest.fixture
def family() -> str:
    return "grbl"


@pytest.fixture
def bench(
    clock: Clock, places: Places, plug_in: Callable, monkeypatch: pytest.MonkeyPatch, family: str
) -> Iterator[Bench]:
    # What waits for an answer waits by the grbl's clock, which goes on with each look for one.
    for module in (conversation, moves, lines):
        monkeypatch.setattr(module, "monotonic", clock)
    monkeypatch.setattr(lines, "GIVE_WAY_S", 0.0)
    monkeypatch.setattr(serial_port, "_READ_SLICE_S", 0.0)
    monkeypatch.setattr(protocol_sim, "LISTEN_S", 0.0)
    monkeypatch.setattr(Attachment, "poll", lambda _: 60.0)
    grbl = FluidNcEmulator(clock) if family == "fluidnc" else GrblEmulator(clock)
    devices, wire = Devices(), Wire(clock, grbl, EXCHANGE_S)
    device = devices.connect(plug_in(wire), family)
    yield Bench(devices, device, wire, places)
    devices.close()


def changed_on_its_way(bench: Bench, asked: int) -> None:
    bench.device.move_by([by(400)], asked)
    bench.pass_time(0.2)
    bench.device.move_to([AxisCommand(0, -300, "to_steps")], asked)


def there_and_back(bench: Bench, asked: int) -> None:
    bench.device.go_there_and_back(Shuttle(0, 50, 3, 0.0), by(50), asked)
    for _ in range(2):
        bench.pass_time(1.0)
        bench.poll()
        bench.poll()


def jog_and_renew(bench: Bench, asked: int) -> None:
    lease = Lease({0: 400.0}, 1e6)
    bench.device.run([AxisCommand(0, 400.0, "speed_steps_per_s")], lease, asked)
    bench.pass_time(0.9)
    lease.renew()
    bench.poll()
    bench.device.run([AxisCommand(0, -200.0, "speed_steps_per_s")], Lease({0: -200.0}, 1e6), asked)


SCENARIOS: dict[str, Callable[[Bench, int], None]] = {
    "move": lambda bench, asked: bench.device.move_by([by(300), by(-200, 1)], asked),
    "change": changed_on_its_way,
    "line": lambda bench, asked: bench.device.line([by(300), by(-200, 1)], None, asked),
    "jog": jog_and_renew,
    "shuttle": there_and_back,
}


def stop_at(bench: Bench, place: int, stop: str, scenario: Callable[[Bench, int], None]) -> bool:
    """Let a scenario be stopped at a place; return whether it came to that. What must never happen fails."""
    bench.reset()

    def ask_to_stop() -> None:
        gate = ExitStack()
        gate.enter_context(bench.device.being_stopped())

        def answer(_: object) -> None:
            gate.close()
            bench.jogs_at_answer = bench.jogs
            bench.answered.set()

        getattr(bench.device, stop)().add_done_callback(answer)

    bench.places.choose(place, ask_to_stop)
    asked = bench.devices.order.next()
    with suppress(StepRampError):
        scenario(bench, asked)
    came_to_it = bench.places.chosen is None
    bench.places.chosen = None
    if came_to_it:
        assert bench.answered.wait(PATIENCE_S)
        judge(bench)
    return came_to_it


def judge(bench: Bench) -> None:
    """No jog is obeyed after the answer, what moves comes to rest, and what is asked afterwards works."""
    bench.pass_time(REST_S)
    steps = bench.grbl.steps
    for _ in range(3):
        bench.pass_time(1.0)
        bench.poll()
    assert bench.jogs == bench.jogs_at_answer, bench.grbl.lines[-5:]
    assert (bench.grbl.steps, bench.grbl.is_moving) == (steps, False)
    assert bench.device.view.state is DeviceState.READY
    assert bench.device.view.shuttle is None
    bench.device.set_position([AxisCommand(0, 0, "position_steps")])
    bench.device.move_by([by(7)])
    bench.pass_time(1.0)
    bench.look()
    assert bench.device.view.position_steps == 7


@pytest.mark.parametrize("stop", ["stop", "halt"])
@pytest.mark.parametrize("name", SCENARIOS)
def test_a_stop_of_a_grbl_at_any_place_is_final(bench: Bench, name: str, stop: str) -> None:
    tried = 0
    while tried < MOST_PLACES and stop_at(bench, tried, stop, SCENARIOS[name]):
        tried += 1
    # At least: the look before, the jog, its answer and the look after it, each with a place before and after.
    assert 16 <= tried < MOST_PLACES


@pytest.mark.parametrize("family", ["fluidnc"])
@pytest.mark.parametrize("stop", ["stop", "halt"])
@pytest.mark.parametrize("name", ["change", "jog"])
def test_a_stop_of_a_fluidnc_at_any_place_is_final(bench: Bench, name: str, stop: str) -> None:
    tried = 0
    while tried < MOST_PLACES and stop_at(bench, tried, stop, SCENARIOS[name]):
        tried += 1
    assert 16 <= tried < MOST_PLACES


def back_from_a_leg(bench: Bench) -> None:
    """Go to and fro, until it is back where it began and is about to set out again."""
    bench.reset()
    bench.device.go_there_and_back(Shuttle(0, 100, 3, 0.0), by(100))
    bench.pass_time(1.0)
    bench.poll()
    bench.pass_time(1.0)
    bench.look()
    assert (bench.device.view.position_steps, bench.device.view.shuttle is None) == (0, False)


def test_to_and_fro_that_ends_by_other_steps_per_mm_says_so_and_the_next_motion_is_refused_once(bench: Bench) -> None:
    back_from_a_leg(bench)
    bench.grbl.settings[100] = 125.0
    bench.poll()
    words = r"\$100 has changed from 250 to 125, so lengths are others now"
    assert bench.device.view.shuttle is None
    assert re.search(f"^To and fro has ended: {words}", bench.device.view.message or "")
    with pytest.raises(Refused, match=words):
        bench.device.move_by([by(250)])
    bench.device.move_by([by(250)])
    assert bench.device.view.message is None


def test_to_and_fro_that_ends_at_a_soft_limit_says_so_until_something_else_is_asked_for(bench: Bench) -> None:
    back_from_a_leg(bench)
    bench.device.limit({0: Span(0, 50)})
    bench.poll()
    assert bench.device.view.shuttle is None
    assert "To and fro has ended: " in (message := bench.device.view.message or "")
    assert "0 to 50 steps" in message
    bench.device.move_by([by(50)])
    assert bench.device.view.message is None
