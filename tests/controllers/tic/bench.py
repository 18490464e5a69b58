"""A Tic whose clock tests set, a client of it, and what tests ask of that."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from controllers.conftest import Clock
from controllers.tic.emulator import READ, TicEmulator
from stepramp.controllers.contract import Activity, AxisCommand, ControllerStatus
from stepramp.controllers.tic.controller import TicController
from stepramp.errors import Rejected
from stepramp.link.protocol_sim import VirtualDevice
from stepramp.link.serial_port import SerialPort

PlugIn = Callable[[VirtualDevice], str]
POLL_S = 0.3
LONG_S = 60.0
TARGET_FAR_AWAY = bytes([0xE0, 0, 0, 0, 0x7F, 0])
"""8,323,072 steps."""


def by(steps: int, axis: int = 0) -> list[AxisCommand]:
    return [AxisCommand(axis, steps, "by_steps")]


def to(position: int) -> list[AxisCommand]:
    return [AxisCommand(0, position, "to_steps")]


def at(speed: float) -> list[AxisCommand]:
    return [AxisCommand(0, speed, "speed_steps_per_s")]


class Bench:
    """A Tic, its clock, and a client of it. lasts_s: how long each exchange takes by that clock."""

    def __init__(self, clock: Clock, plug_in: PlugIn) -> None:
        self.clock = clock
        self.lasts_s = 0.002
        self.tic = TicEmulator(clock)
        self.port = SerialPort(plug_in(self))
        self.interrupt: Callable[[], None] = lambda: None
        self.controller = TicController(self.port, self.give_way)
        self.way: list[int] = []
        """All positions that the motor was seen at."""

    def opened(self) -> None:
        self.tic.opened()

    def exchange(self, sent: bytes) -> bytes:
        if sent:
            self.clock.now_s += self.lasts_s
        said = self.tic.exchange(sent)
        self.way.append(self.tic.position)
        return said

    def give_way(self, pause_s: float) -> None:
        self.clock.now_s += pause_s
        self.interrupt()

    def pass_time(self, time_s: float) -> None:
        """Let time go on with nobody asking."""
        until_s = self.clock.now_s + time_s
        while self.clock.now_s < until_s:
            self.clock.now_s += 0.01
            self.exchange(b"")

    def wait_until(self, *activities: Activity) -> ControllerStatus:
        """Ask as often as a device does while it moves, until it does so."""
        for _ in range(int(LONG_S / POLL_S)):
            status = self.controller.status()
            if status.activity in activities:
                return status
            self.pass_time(POLL_S)
        raise AssertionError(status)

    def rest(self) -> ControllerStatus:
        return self.wait_until(Activity.READY)

    def told(self) -> list[int]:
        """Return the first bytes of the commands that are no questions."""
        return [each[0] for each in self.tic.commands if each[0] not in READ]


def only_rejection(ask: Callable[[], object]) -> tuple[str, object, str]:
    with pytest.raises(Rejected) as caught:
        ask()
    [rejection] = caught.value.rejections
    return rejection.field, rejection.value, rejection.allowed
