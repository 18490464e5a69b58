"""The program that may be stored in a module, and what else the module as a whole tells."""

from contextlib import suppress

from stepramp.controllers.tmcl.conversation import Conversation, Denied
from stepramp.controllers.tmcl.wire import Command
from stepramp.errors import DeviceLost

PROGRAM_STATUS = 128
"""Global parameter: 0 while no program runs."""
TICKS = 132
"""Global parameter: since the module was switched on or reset [ms]."""
RUNS = "A program that is stored in the module runs and may move its motors: stop it first, as STOP does."


class Program:
    """The module's own program, and its clock."""

    def __init__(self, conversation: Conversation) -> None:
        self._conversation = conversation
        self._ticks: int | None = None

    @property
    def runs(self) -> bool:
        """Ask whether the program runs; a module without any says no."""
        try:
            return self._conversation.ask(Command.GGP, PROGRAM_STATUS) == 1
        except Denied:
            return False

    def end(self) -> bool:
        """End the program if it runs; return whether it did."""
        if not self.runs:
            return False
        self._conversation.ask(Command.STOP_PROGRAM)
        return True

    def refuse_restarted(self) -> None:
        """Raise DeviceLost when the module was restarted since the last time: it counts its positions from 0 then."""
        ticks = None
        with suppress(Denied):
            ticks = self._conversation.ask(Command.GGP, TICKS)
        # Noted at once: something more urgent may look, too, before the next question.
        before, self._ticks = self._ticks, ticks
        if before is not None and ticks is not None and (ticks - before) % 2**32 >= 2**31:
            raise DeviceLost(
                f"The TMCL module at {self._conversation.name} was restarted: its positions are no longer known."
            )
