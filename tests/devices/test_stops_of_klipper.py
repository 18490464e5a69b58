"""A stop of a Klipper that was answered is final: at every place where its port's thread gives way, reads or writes.

As in test_stops.py: deterministic, nothing polls unless it is told to. Time goes on with what is exchanged.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from contextlib import ExitStack, suppress
from dataclasses import replace

import pytest

from controllers.conftest import Clock
from controllers.klipper.bench import Bench
from devices.bench import POLL, Places, by, worker_of
from devices.motion import PATIENCE_S
from stepramp.controllers.contract import AxisCommand
from stepramp.controllers.families import FAMILIES
from stepramp.controllers.klipper import moves, stopping
from stepramp.devices.attachment import Attachment
from stepramp.devices.leases import Lease
from stepramp.devices.registry import Devices
from stepramp.devices.shuttle import Shuttle
from stepramp.devices.stopping import NotStopped
from stepramp.devices.view import DeviceState
from stepramp.errors import DeviceLost, Refused, StepRampError

EXCHANGE_S = 0.1
REST_S = 5.0
MOST_PLACES = 400
AS_IT_CAME = {"absolute": True, "factor": 1.0, "feed": 1500.0}


class Tried:
    """A device that is a Klipper: x has 80 steps/mm, 20 mm/s and 100 mm/s²."""

    def __init__(self, places: Places) -> None:
        self.clock = Clock()
        self.port = Bench(self.clock)
        self.port.lasts_s = EXCHANGE_S
        self.places = places
        self.printer = self.port.printer
        self.printer.velocity, self.printer.accel = 20.0, 100.0
        self.devices = Devices({"klipper": replace(FAMILIES["klipper"], open=self._opened)})
        self.device = self.devices.connect("moonraker://printer:7125", "klipper")
        self.told_at_answer = 0
        self.answered = threading.Event()

    def _opened(self, _: str, before_write: Callable[[], None], *__: object) -> Bench:
        self.port.before_write = before_write
        return self.port

    @property
    def told(self) -> int:
        return sum("G1" in script for script in self.printer.scripts)

    def pass_time(self, time_s: float) -> None:
        self.clock.now_s += time_s
        self.printer.advance()

    def poll(self) -> None:
        self.device._attachment._watch.is_view_old = True
        worker_of(self.device).call(lambda: POLL(self.device._attachment))


def changed_on_its_way(tried: Tried, asked: int) -> None:
    tried.device.move_by([by(4000)], asked)
    tried.pass_time(0.5)
    tried.poll()
    tried.device.move_to([AxisCommand(0, 7000, "to_steps")], asked)


def told_on(tried: Tried, asked: int) -> None:
    tried.device.move_by([by(8000)], asked)
    for _ in range(8):
        tried.pass_time(0.3)
        tried.poll()


def jog_and_renew(tried: Tried, asked: int) -> None:
    lease = Lease({0: 800.0}, 1e6)
    tried.device.run([AxisCommand(0, 800.0, "speed_steps_per_s")], lease, asked)
    for _ in range(4):
        tried.pass_time(0.4)
        tried.poll()


def there_and_back(tried: Tried, asked: int) -> None:
    tried.device.go_there_and_back(Shuttle(0, 80, 3, 0.0), by(80), asked)
    for _ in range(3):
        tried.pass_time(2.0)
        tried.poll()
        tried.poll()


def refused(tried: Tried, asked: int) -> None:
    tried.printer.refuses = "Move out of range"
    with suppress(Refused):
        told_on(tried, asked)
    tried.printer.refuses = None
    told_on(tried, asked)
    tried.printer.refuses = "Printer is paused"
    tried.pass_time(0.3)
    tried.poll()


SCENARIOS: dict[str, Callable[[Tried, int], None]] = {
    "move": told_on,
    "change": changed_on_its_way,
    "line": lambda tried, asked: tried.device.line([by(300), by(-200, 1)], None, asked),
    "jog": jog_and_renew,
    "shuttle": there_and_back,
    "refused": refused,
}


@pytest.fixture
def watched(places: Places, monkeypatch: pytest.MonkeyPatch) -> Places:
    for name in ("write", "read"):
        monkeypatch.setattr(Bench, name, places.around(getattr(Bench, name)))
    # Answers come at once, but a machine that has much to do may let this wait: what waits for them is as it is.
    for module, name, value in (
        (stopping, "SCRIPTS_S", 0.2),
        (moves, "LOOK_S", 0.0),
        (moves, "BUSY_S", 0.5),
    ):
        monkeypatch.setattr(module, name, value)
    monkeypatch.setattr(Attachment, "poll", lambda _: 60.0)
    return places


def stop_at(places: Places, place: int, stop: str, scenario: Callable[[Tried, int], None]) -> bool:
    """Let a scenario be stopped at a place; return whether it came to that. What must never happen fails."""
    tried = Tried(places)

    def ask_to_stop() -> None:
        gate = ExitStack()
        gate.enter_context(tried.device.being_stopped())

        def answer(_: object) -> None:
            gate.close()
            tried.told_at_answer = tried.told
            tried.answered.set()

        getattr(tried.device, stop)().add_done_callback(answer)

    places.choose(place, ask_to_stop)
    asked = tried.devices.order.next()
    with suppress(StepRampError):
        scenario(tried, asked)
    came_to_it = places.chosen is None
    places.chosen = None
    if came_to_it:
        assert tried.answered.wait(PATIENCE_S)
        judge(tried)
    tried.devices.close()
    return came_to_it


def judge(tried: Tried) -> None:
    """Nothing is told after the answer, what moves comes to rest, and what is asked afterwards works."""
    tried.printer.refuses = None
    for _ in range(3):
        tried.pass_time(REST_S)
        tried.poll()
    assert tried.told == tried.told_at_answer
    assert tried.printer.queue == []
    assert tried.device.view.state is DeviceState.READY
    assert tried.device.view.shuttle is None
    assert tried.port.moonraker.wrong == []
    if tried.printer.state == "shutdown":
        return
    assert tried.printer.gcode == AS_IT_CAME
    before = tried.device.view.axes[0].position_steps
    tried.device.move_by([by(8)])
    tried.pass_time(REST_S)
    tried.poll()
    assert tried.device.view.axes[0].position_steps == before + 8


@pytest.mark.parametrize("stop", ["stop", "halt"])
@pytest.mark.parametrize("name", SCENARIOS)
def test_a_stop_of_a_klipper_at_any_place_is_final(watched: Places, name: str, stop: str) -> None:
    tried = 0
    while tried < MOST_PLACES and stop_at(watched, tried, stop, SCENARIOS[name]):
        tried += 1
    # At least: the look before, the part, its answer and the look after it, each with a place before and after.
    assert 12 <= tried < MOST_PLACES


OTHERS_MOVE = "told to Klipper by somebody else"


def print_on(tried: Tried, monkeypatch: pytest.MonkeyPatch) -> None:
    """Somebody prints, and the tool moves for long; nothing polls unless it is told to."""
    monkeypatch.setattr(Attachment, "poll", lambda _: 60.0)
    tried.printer.run("G91\nG1 X100 F60\nG90")
    tried.printer.prints = "printing"
    tried.pass_time(1.0)
    tried.poll()
    assert tried.device.view.state is DeviceState.MOVING


def lose(tried: Tried) -> None:
    worker_of(tried.device).lose(DeviceLost("The network is gone."))
    worker_of(tried.device).close()
    assert tried.device.view.state is DeviceState.LOST
    tried.port.reopen()


def test_a_stop_that_was_refused_does_not_keep_a_printing_klipper_from_being_connected_and_halted(
    places: Places, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried = Tried(places)
    print_on(tried, monkeypatch)
    with pytest.raises(NotStopped, match=OTHERS_MOVE):
        tried.device.stop().result(PATIENCE_S)
    lose(tried)
    tried.devices.connect(tried.device.view.port, "klipper")
    assert tried.device.view.state is DeviceState.MOVING
    assert OTHERS_MOVE in (tried.device.view.message or "")
    assert tried.printer.state == "ready"
    tried.device.halt().result(PATIENCE_S)
    assert tried.printer.state == "shutdown"
    tried.devices.close()


def test_a_halt_that_is_owed_is_a_halt_once_it_is_connected(places: Places, monkeypatch: pytest.MonkeyPatch) -> None:
    tried = Tried(places)
    print_on(tried, monkeypatch)
    lose(tried)
    for stop in (tried.device.halt, tried.device.stop):
        with pytest.raises(DeviceLost):
            stop()
    tried.devices.connect(tried.device.view.port, "klipper")
    assert tried.printer.state == "shutdown"
    assert "Klipper isn't ready" in (tried.device.view.message or "")
    tried.devices.close()


@pytest.mark.parametrize("settled_by", ["rest", "motion"])
def test_a_stop_that_was_refused_is_owed_no_more_once_it_rests_or_moves_for_us(
    places: Places, monkeypatch: pytest.MonkeyPatch, settled_by: str
) -> None:
    tried = Tried(places)
    print_on(tried, monkeypatch)
    with pytest.raises(NotStopped):
        tried.device.stop().result(PATIENCE_S)
    tried.printer.prints = "standby"
    tried.printer.emergency_stop()
    tried.printer.state = "ready"
    tried.clock.now_s += 1.0
    if settled_by == "rest":
        tried.poll()
        tried.poll()
        assert tried.device.view.message is None
    else:
        tried.device.move_by([by(4000)])
        # It rests before it was seen to.
        tried.pass_time(REST_S)
    tried.printer.prints = "printing"
    lose(tried)
    tried.devices.connect(tried.device.view.port, "klipper")
    assert OTHERS_MOVE not in (tried.device.view.message or "")
    tried.devices.close()
