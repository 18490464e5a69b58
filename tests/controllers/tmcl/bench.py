"""A module whose clock tests set, and a client of it."""

from __future__ import annotations

from controllers.bench import BoardBench, PlugIn
from controllers.conftest import Clock
from controllers.tmcl.emulator import QUESTIONS, TmclEmulator
from stepramp.controllers.tmcl.controller import TmclController


class Bench(BoardBench[TmclController]):
    """A module on its bench."""

    def __init__(self, clock: Clock, plug_in: PlugIn, module: TmclEmulator) -> None:
        self.module = module
        super().__init__(clock, plug_in, module, TmclController)

    def told(self) -> list[int]:
        """Return the commands that are no questions."""
        return [each[0] for each in self.module.commands if each[0] not in QUESTIONS]
