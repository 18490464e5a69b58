"""How often a controller is asked, that a Tic hears of that often enough, and what a stop does in its midst."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Future
from typing import Any

import pytest

from controllers.conftest import Clock
from controllers.plain_controller import NoWire, PlainController
from controllers.tic.emulator import TicEmulator
from designs import design
from devices.bench import POLL, worker_of
from devices.motion import PATIENCE_S
from stepramp.controllers.contract import Activity, AxisCommand, AxisStatus, ControllerStatus
from stepramp.controllers.families import Family
from stepramp.controllers.progress import Tell
from stepramp.devices import view, watch
from stepramp.devices.attachment import Attachment
from stepramp.devices.device import Device
from stepramp.devices.registry import Devices
from stepramp.devices.view import DeviceState
from stepramp.link.connection import Connection

EXCHANGE_S = 0.01
MOST_SILENCE_S = 0.5


class SlowTic:
    """A Tic at a port where each exchange takes time. asked_at_s: when it was asked how it fares."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self.tic = TicEmulator(clock)
        self.asked_at_s: list[float] = []

    def opened(self) -> None:
        self.tic.opened()

    def exchange(self, sent: bytes) -> bytes:
        if sent:
            self._clock.now_s += EXCHANGE_S
        if sent[:2] == b"\xa1\x00":
            self.asked_at_s.append(self._clock.now_s)
        return self.tic.exchange(sent)


@pytest.fixture
def tic(clock: Clock) -> SlowTic:
    tic = SlowTic(clock)
    tic.tic.has_been_up(60)
    return tic


@pytest.fixture
def device(
    clock: Clock, tic: SlowTic, plug_in: Callable[[object], str], monkeypatch: pytest.MonkeyPatch
) -> Iterator[Device]:
    # It is looked at when the test says so.
    monkeypatch.setattr(Attachment, "poll", lambda _: 60.0)
    monkeypatch.setattr(watch, "monotonic", clock)
    devices = Devices()
    yield devices.connect(plug_in(tic), "tic")
    devices.close()


def look_for(device: Device, clock: Clock, time_s: float) -> None:
    """Look at a device as often as it wants to be, as its port's thread does."""
    until_s = clock.now_s + time_s
    while clock.now_s < until_s:
        clock.now_s += worker_of(device).call(lambda: POLL(device._attachment))


def test_a_controller_at_rest_is_asked_each_half_second(device: Device, clock: Clock, tic: SlowTic) -> None:
    tic.asked_at_s.clear()
    look_for(device, clock, 10)
    gaps_s = [after - before for before, after in zip(tic.asked_at_s, tic.asked_at_s[1:], strict=False)]
    assert len(gaps_s) > 15
    assert max(gaps_s) < MOST_SILENCE_S + EXCHANGE_S


def test_what_was_heard_of_a_controller_has_an_age(
    device: Device, clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(view, "monotonic", clock)
    look_for(device, clock, 1)
    heard_s = device.view.heard_s
    clock.now_s = heard_s + 7.25
    assert device.view.age_s == pytest.approx(7.25)
    assert device.view.anew("there", "again").age_s is None, "it has said nothing yet"


def test_a_tic_at_rest_after_a_move_has_no_trouble(device: Device, clock: Clock, tic: SlowTic) -> None:
    device.push([design()], mode="try")
    device.move_by([AxisCommand(0, 200, "by_steps")])
    look_for(device, clock, 4)
    assert (device.view.state, device.view.position_steps) == (DeviceState.READY, 200)
    for _ in range(40):
        look_for(device, clock, 0.1)
        assert device.view.message is None
        assert tic.tic.errors == 0


class Stoppable(PlainController):
    """An axis that moves until it is stopped. looked: called in the midst of each status, before it gives way."""

    def __init__(self, connection: Connection, give_way: Callable[[float], None], tell: Tell) -> None:
        super().__init__(connection, give_way, tell)
        self.looked: Callable[[], None] = lambda: None
        self._give_way = give_way

    def status(self) -> ControllerStatus:
        activity = Activity.MOVING if self.asked[-1:] == ["move_by"] else Activity.READY
        axis = AxisStatus(0, activity, 0, 0, 0.0, 0)
        self.looked()
        self._give_way(0.0)
        return ControllerStatus(activity, (axis,), None, on_trial=False, motors_on=True)


def test_a_stop_in_the_midst_of_asking_has_it_asked_again_right_away(
    clock: Clock, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Though that isn't due yet, by a clock that stands still."""
    made: list[Stoppable] = []

    def make(*asked: Any) -> Stoppable:
        made.append(Stoppable(*asked))
        return made[-1]

    monkeypatch.setattr(Attachment, "poll", lambda _: 60.0)
    monkeypatch.setattr(watch, "monotonic", clock)
    devices = Devices({"plain": Family("plain", "Plain", NoWire, make)})
    device = devices.connect("at a plain wire", "plain")
    device.move_by([AxisCommand(0, 5, "by_steps")])
    stops: list[Future[None]] = []

    def stop_once() -> None:
        made[0].looked = lambda: None
        stops.append(device.stop())

    made[0].looked = stop_once
    worker_of(device).call(device._attachment._watch.refresh)
    stops[0].result(PATIENCE_S)
    worker_of(device).call(lambda: POLL(device._attachment))
    assert device.view.state is DeviceState.READY
    devices.close()
