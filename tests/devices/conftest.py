from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from controllers.conftest import Clock, clock, controller, plug_in, virtual
from controllers.usb_board import Cable
from devices.bench import ROLES, Bench, Places, push
from devices.boards import UnpluggedAt, Witness
from stepramp.controllers.stepramp import conversation, tracing
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.devices.attachment import Attachment
from stepramp.devices.registry import Devices
from stepramp.link import protocol_sim
from stepramp.link.serial_port import SerialPort
from stepramp.link.worker import Worker

__all__ = ["clock", "controller", "plug_in", "virtual"]


@pytest.fixture
def devices() -> Iterator[Devices]:
    devices = Devices()
    devices.look_for_lost_ones()
    yield devices
    devices.close()


@pytest.fixture
def port(plug_in: Callable) -> str:
    """Return the port of a virtual controller that is in real time and forgets nothing."""
    return plug_in(VirtualController())


@pytest.fixture
def cable(tmp_path: Path) -> Iterator[Cable]:
    made = Cable(tmp_path / "ttyACM0")
    made.plug_in()
    yield made
    made.unplug()


@pytest.fixture
def places(monkeypatch: pytest.MonkeyPatch) -> Places:
    places = Places()
    watched = (Worker, "give_way"), (SerialPort, "write"), (SerialPort, "read"), (protocol_sim.Serial, "write")
    for owner, name in watched:
        monkeypatch.setattr(owner, name, places.around(getattr(owner, name)))
    return places


@pytest.fixture
def bench(clock: Clock, places: Places, plug_in: Callable, monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    # Answers come at once or not at all, and traces are not waited for: the motors' clock stands still.
    monkeypatch.setattr(conversation, "REPLY_TIMEOUT_S", 0.003)
    monkeypatch.setattr(conversation, "GARBAGE_S", 0.0)
    monkeypatch.setattr(tracing, "LAST_FRAME_WITHIN_S", 0.001)
    monkeypatch.setattr(tracing, "LISTEN_S", 0.001)
    monkeypatch.setattr(protocol_sim, "LISTEN_S", 0.0005)
    devices, witness = Devices(), Witness(clock)
    # Nothing is asked of the controller but what the test asks for.
    monkeypatch.setattr(Attachment, "poll", lambda _: 60.0)
    device = devices.connect(plug_in(witness))
    push(device, clock)
    device.use_settings(StepRampSettings.checked({"inputs": ROLES}))
    yield Bench(devices, device, witness, clock, places)
    devices.close()


@pytest.fixture
def unplugged_at(clock: Clock) -> UnpluggedAt:
    board = UnpluggedAt(clock)
    VirtualController.opened(board.controller)
    return board
