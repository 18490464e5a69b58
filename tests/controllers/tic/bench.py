"""A Tic whose clock tests set, and a client of it."""

from __future__ import annotations

from controllers.bench import BoardBench, PlugIn
from controllers.conftest import Clock
from controllers.tic.emulator import READ, TicEmulator
from stepramp.controllers.tic.controller import TicController

TARGET_FAR_AWAY = bytes([0xE0, 0, 0, 0, 0x7F, 0])
"""8,323,072 steps."""


class Bench(BoardBench[TicController]):
    """A Tic on its bench."""

    def __init__(self, clock: Clock, plug_in: PlugIn) -> None:
        self.tic = TicEmulator(clock)
        self.way: list[int] = []
        """All positions that the motor was seen at."""
        super().__init__(clock, plug_in, self.tic, TicController)

    def exchange(self, sent: bytes) -> bytes:
        said = super().exchange(sent)
        self.way.append(self.tic.position)
        return said

    def told(self) -> list[int]:
        """Return the first bytes of the commands that are no questions."""
        return [each[0] for each in self.tic.commands if each[0] not in READ]
