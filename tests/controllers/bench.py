"""A board whose clock tests set, a client of it, and what tests ask of that, for any family that answers when asked."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, Protocol, TypeVar

import pytest

from controllers.conftest import Clock
from stepramp.controllers.contract import Activity, AxisCommand, Controller, ControllerStatus
from stepramp.errors import Rejected
from stepramp.link.connection import Connection
from stepramp.link.protocol_sim import VirtualDevice
from stepramp.link.serial_port import SerialPort

PlugIn = Callable[[VirtualDevice], str]
POLL_S = 0.3
LONG_S = 60.0
C = TypeVar("C", bound=Controller)


def by(steps: int, axis: int = 0) -> list[AxisCommand]:
    return [AxisCommand(axis, steps, "by_steps")]


def to(position: int, axis: int = 0) -> list[AxisCommand]:
    return [AxisCommand(axis, position, "to_steps")]


def at(speed: float, axis: int = 0) -> list[AxisCommand]:
    return [AxisCommand(axis, speed, "speed_steps_per_s")]


class Makes(Protocol[C]):
    """A class of controllers."""

    def __call__(self, port: Connection, give_way: Callable[[float], None], /) -> C: ...


class BoardBench(Generic[C]):
    """A board, its clock, and a client of it. lasts_s: how long each exchange takes by that clock."""

    def __init__(self, clock: Clock, plug_in: PlugIn, board: VirtualDevice, make: Makes[C]) -> None:
        self.clock = clock
        self.lasts_s = 0.002
        self.interrupt: Callable[[], None] = lambda: None
        self._board, self._make = board, make
        self._port_name = plug_in(self)
        self.reopen()

    def reopen(self) -> None:
        """Open the port, for a client that isn't connected yet."""
        self.port = SerialPort(self._port_name)
        self.controller = self._make(self.port, self.give_way)

    def opened(self) -> None:
        self._board.opened()

    def exchange(self, sent: bytes) -> bytes:
        if sent:
            self.clock.now_s += self.lasts_s
        return self._board.exchange(sent)

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


def only_rejection(ask: Callable[[], object]) -> tuple[str, object, str]:
    with pytest.raises(Rejected) as caught:
        ask()
    [rejection] = caught.value.rejections
    return rejection.field, rejection.value, rejection.allowed
