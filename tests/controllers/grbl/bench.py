"""A grbl whose clock tests set, a client of it, and what tests ask of that."""

from __future__ import annotations

from collections.abc import Callable

from controllers.conftest import Clock
from controllers.grbl.emulator import Eeprom, GrblEmulator
from stepramp.controllers.contract import Activity, AxisCommand, ControllerStatus
from stepramp.controllers.grbl.controller import GrblController
from stepramp.controllers.grbl.machine import GrblMachine
from stepramp.link.protocol_sim import VirtualDevice
from stepramp.link.serial_port import SerialPort

PlugIn = Callable[[VirtualDevice], str]
POLL_S = 0.3
LONG_S = 120.0


def by(steps: int, axis: int = 0) -> AxisCommand:
    return AxisCommand(axis, steps, "by_steps")


def to(position: int, axis: int = 0) -> AxisCommand:
    return AxisCommand(axis, position, "to_steps")


def at(speed: float, axis: int = 0) -> AxisCommand:
    return AxisCommand(axis, speed, "speed_steps_per_s")


class Bench:
    """A grbl, or one that is spoken to as such, its clock, and a client of it.

    lasts_s: how long each exchange takes by that clock.
    """

    client: type[GrblMachine] = GrblController

    def __init__(self, clock: Clock, plug_in: PlugIn, eeprom: Eeprom | None = None) -> None:
        self.clock = clock
        self.lasts_s = 0.002
        self.grbl = self.plugged_in(eeprom)
        self._name = plug_in(self)
        self.interrupt: Callable[[], None] = lambda: None
        self.reopen()

    def reopen(self) -> None:
        """Open the port, for a client that isn't connected yet."""
        self.port = SerialPort(self._name)
        self.controller = self.client(self.port, self.give_way)  # type: ignore[call-arg, arg-type]

    def plugged_in(self, eeprom: Eeprom | None) -> GrblEmulator:
        return GrblEmulator(self.clock, eeprom)

    def opened(self) -> None:
        self.grbl.opened()

    def exchange(self, sent: bytes) -> bytes:
        self.clock.now_s += self.lasts_s
        return self.grbl.exchange(sent)

    def give_way(self, pause_s: float) -> None:
        self.clock.now_s += pause_s
        self.interrupt()

    def pass_time(self, time_s: float) -> None:
        """Let time go on with nobody asking."""
        until_s = self.clock.now_s + time_s
        while self.clock.now_s < until_s:
            self.clock.now_s += 0.01
            self.grbl.exchange(b"")

    def ask_for(self, time_s: float) -> ControllerStatus:
        """Ask as often as a device does while it moves, for so long."""
        for _ in range(round(time_s / POLL_S)):
            status = self.controller.status()
            self.pass_time(POLL_S)
        return status

    def rest(self) -> ControllerStatus:
        """Ask until everything rests."""
        for _ in range(round(LONG_S / POLL_S)):
            status = self.controller.status()
            if status.activity is Activity.READY:
                return status
            self.pass_time(POLL_S)
        raise AssertionError(status)
