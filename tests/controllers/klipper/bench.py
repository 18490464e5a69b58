"""A printer whose clock tests set, a client of it over a port within this process, and what tests ask of that."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from controllers.conftest import Clock
from controllers.klipper.moonraker import Moonraker
from controllers.klipper.printer import Printer
from designs import design
from stepramp.controllers.contract import Activity, AxisCommand, ControllerStatus, PushMode
from stepramp.controllers.klipper.controller import KlipperController
from stepramp.errors import DeviceLost
from stepramp.link.moonraker_port import FILE_S, Reply

POLL_S = 0.1
LONG_S = 120.0
# 80 steps/mm in x, 160 in y, 400 in z.
SLOW = design(ramp__slew_speed_steps_per_s=8000, ramp__acceleration_steps_per_s2=80_000)


def pushed(controller: KlipperController, mode: PushMode = "keep", axis: int = 0) -> None:
    report = controller.prepare_push([SLOW], axis, mode)()
    assert report.verified, report


def by(steps: int, axis: int = 0) -> AxisCommand:
    return AxisCommand(axis, steps, "by_steps")


def to(position: int, axis: int = 0) -> AxisCommand:
    return AxisCommand(axis, position, "to_steps")


def at(speed: float, axis: int = 0) -> AxisCommand:
    return AxisCommand(axis, speed, "speed_steps_per_s")


class Bench:
    """A port with Moonraker behind it, and a client that isn't connected yet.

    lasts_s, file_lasts_s: how long a message takes, and a file.
    """

    name = "moonraker://printer:7125"

    def __init__(self, clock: Clock, files: dict[str, str] | None = None) -> None:
        self.clock = clock
        self.lasts_s = self.file_lasts_s = 0.005
        self.printer = Printer(clock, files)
        self.moonraker = Moonraker(self.printer)
        self.before_write: Callable[[], None] = lambda: None
        self.interrupt: Callable[[], None] = lambda: None
        self.reopen()

    def reopen(self) -> None:
        self._inbox: deque[bytes] = deque()
        self.controller = KlipperController(self, self.give_way)

    def connected(self) -> KlipperController:
        self.controller.connect()
        self.moonraker.asked.clear()
        return self.controller

    def write(self, data: bytes) -> None:
        self.before_write()
        self.clock.now_s += self.lasts_s
        self.hear(self.moonraker.message(data.decode()))

    def read(self, timeout_s: float) -> bytes:
        if not self._inbox:
            self.clock.now_s += timeout_s
            self.hear(self.moonraker.notifications())
        return self._inbox.popleft() if self._inbox else b""

    def pending(self) -> bytes:
        self.hear(self.moonraker.notifications())
        return self._inbox.popleft() if self._inbox else b""

    def close(self) -> None:
        pass

    def request(
        self,
        method: str,
        path: str,
        give_way: Callable[[float], None],
        body: bytes = b"",
        content_type: str = "application/json",
        time_s: float = FILE_S,
    ) -> Reply:
        give_way(0.0)
        self.clock.now_s += min(self.file_lasts_s, time_s)
        if self.file_lasts_s > time_s:
            raise DeviceLost("It doesn't give its files.")
        try:
            return Reply(*self.moonraker.http(method, path, {"content-type": content_type}, body))
        except ConnectionError as error:
            raise DeviceLost("gone") from error

    def hear(self, messages: list[str]) -> None:
        self._inbox.extend(message.encode() for message in messages)

    def give_way(self, pause_s: float) -> None:
        self.clock.now_s += pause_s
        self.interrupt()

    def pass_time(self, time_s: float) -> None:
        """Let time go on with nobody asking."""
        self.clock.now_s += time_s
        self.printer.advance()

    def ask_for(self, time_s: float) -> ControllerStatus:
        """Ask as often as a device does while it moves, for so long."""
        until_s = self.clock.now_s + time_s
        while True:
            status = self.controller.status()
            self.pass_time(POLL_S)
            if self.clock.now_s >= until_s:
                return status

    def rest(self) -> ControllerStatus:
        """Ask until everything rests."""
        until_s = self.clock.now_s + LONG_S
        while self.clock.now_s < until_s:
            status = self.controller.status()
            if status.activity is Activity.READY:
                return status
            self.pass_time(POLL_S)
        raise AssertionError(status)

    @property
    def lines(self) -> list[str]:
        """The lines of G-code that were carried out."""
        return [line for script in self.printer.scripts for line in script.split("\n")]
