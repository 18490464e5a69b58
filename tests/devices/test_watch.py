"""How often a controller at rest is asked, and that a Tic hears of that often enough. By a clock that tests set."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from controllers.conftest import Clock
from controllers.tic.emulator import TicEmulator
from designs import design
from devices.bench import POLL, worker_of
from stepramp.controllers.contract import AxisCommand
from stepramp.devices import watch
from stepramp.devices.attachment import Attachment
from stepramp.devices.device import Device
from stepramp.devices.registry import Devices
from stepramp.devices.view import DeviceState

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


def test_a_tic_at_rest_after_a_move_has_no_trouble(device: Device, clock: Clock, tic: SlowTic) -> None:
    device.push([design()], mode="try")
    device.move_by([AxisCommand(0, 200, "by_steps")])
    look_for(device, clock, 4)
    assert (device.view.state, device.view.position_steps) == (DeviceState.READY, 200)
    for _ in range(40):
        look_for(device, clock, 0.1)
        assert device.view.message is None
        assert tic.tic.errors == 0
