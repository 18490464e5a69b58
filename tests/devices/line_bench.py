"""A device that is told lines, as a grbl or a Marlin, at a port whose exchanges take a while by its clock."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from controllers.conftest import Clock
from devices.bench import POLL, Places, worker_of
from stepramp.devices.device import Device
from stepramp.devices.registry import Devices


class Emulator(Protocol):
    """What is at the port."""

    def opened(self) -> None: ...

    def exchange(self, sent: bytes) -> bytes: ...


E = TypeVar("E", bound=Emulator)


class Wire(Generic[E]):
    """The port."""

    def __init__(self, clock: Clock, emulator: E, exchange_s: float) -> None:
        self.clock = clock
        self.emulator = emulator
        self._exchange_s = exchange_s

    def opened(self) -> None:
        self.emulator.opened()

    def exchange(self, sent: bytes) -> bytes:
        self.clock.now_s += self._exchange_s
        return self.emulator.exchange(sent)


@dataclass
class LineBench(Generic[E]):
    """The device; nothing polls it unless it is told to."""

    devices: Devices
    device: Device
    wire: Wire[E]
    places: Places

    def poll(self) -> None:
        self.device._attachment._watch.is_view_old = True
        worker_of(self.device).call(lambda: POLL(self.device._attachment))
