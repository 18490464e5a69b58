"""A Marlin whose clock tests set, and a client of it."""

from __future__ import annotations

from controllers.bench import POLL_S, BoardBench, PlugIn
from controllers.conftest import Clock
from controllers.marlin.emulator import Eeprom, MarlinEmulator
from stepramp.controllers.contract import ControllerStatus
from stepramp.controllers.marlin.controller import MarlinController

QUESTIONS = {"M115", "M110 N0", "M114", "M114 R", "M503", "M400", "M27", "M119", "M92"}


class Bench(BoardBench[MarlinController]):
    """A Marlin on its bench."""

    def __init__(self, clock: Clock, plug_in: PlugIn, eeprom: Eeprom | None = None) -> None:
        self.marlin = MarlinEmulator(clock, eeprom)
        self._unread = b""
        super().__init__(clock, plug_in, self.marlin, MarlinController)

    def exchange(self, sent: bytes) -> bytes:
        # It takes its time to answer, whether anybody sends something or not.
        self.clock.now_s += self.lasts_s
        said, self._unread = self._unread + self.marlin.exchange(sent), b""
        return said

    def pass_time(self, time_s: float) -> None:
        """Let time go on with nobody asking; what it says meanwhile is read later."""
        until_s = self.clock.now_s + time_s
        while self.clock.now_s < until_s:
            self.clock.now_s += 0.01
            self._unread += self.marlin.exchange(b"")

    def told(self) -> list[str]:
        """Return the lines that are no questions."""
        return [line for line in self.marlin.lines if line not in QUESTIONS]

    def ask_for(self, time_s: float) -> ControllerStatus:
        """Ask as often as a device does while it moves, for so long."""
        for _ in range(round(time_s / POLL_S)):
            status = self.controller.status()
            self.pass_time(POLL_S)
        return status
