"""What a Marlin keeps: its settings, read, written one at a time, stored, and proven to be stored by loading them."""

import re
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction

from stepramp.controllers.marlin.conversation import Conversation
from stepramp.controllers.marlin.dialect import (
    IDENTIFY,
    LOAD,
    NOT_PRINTING,
    PRINTING,
    PRINTS,
    SETTINGS,
    STORE,
)
from stepramp.controllers.marlin.exchange import Answered
from stepramp.controllers.marlin.settings import Settings, is_same
from stepramp.errors import Refused

LISTED = re.compile(r"(?:echo:)?\s*M92 .*")
FIRMWARE = re.compile(r"FIRMWARE_NAME:.*")
PRINTING_TOLD = re.compile(f"{PRINTS.pattern}|{NOT_PRINTING.pattern}")
STORING_S = 6.0
"""So long storing may take [s]: an EEPROM takes 3.4 ms a byte."""
LISTINGS = ((IDENTIFY, FIRMWARE), (SETTINGS, LISTED))
Figure = tuple[str, str]
"""A command, and the letter of one of its numbers: M201, X."""


class NotStored(Refused):
    """A Marlin hasn't stored its settings."""


class Memory:
    """The memory of a Marlin as it was last read.

    refuse_moving: raises Refused while something moves.
    """

    def __init__(self, conversation: Conversation, refuse_moving: Callable[[], None]) -> None:
        self._conversation = conversation
        self._refuse_moving = refuse_moving
        self.settings = Settings([])
        self.on_trial = False
        """What is in use isn't stored, as far as was heard over this connection."""

    @property
    def stores(self) -> bool:
        """Whether it was built to store settings."""
        return self._conversation.capabilities.get("EEPROM", True)

    def learn(self) -> None:
        """Read the settings in use; Refused for those that are told in inches."""
        self.settings = Settings.of(self._conversation.ask(SETTINGS, LISTED))
        if self.settings.is_in_inches:
            raise Refused(
                f"The Marlin at {self._conversation.name} counts in inches (G20): say G21 at the machine first."
            )

    def everything(self) -> str:
        """Return all that can be read, as it was told."""
        asked = [(f"; {listing}", *self._conversation.ask(listing, needs)) for listing, needs in LISTINGS]
        return "\n".join(line for lines in asked for line in lines) + "\n"

    def refuse_unready(self) -> None:
        """Refused where a setting may not be changed: only at rest, and while nothing is printed."""
        self._refuse_moving()
        self.refuse_printing()

    def refuse_printing(self) -> None:
        """Refused while it prints a file of its own."""
        if not self._conversation.capabilities.get("SDCARD", False):
            return
        said = self._conversation.ask(PRINTING, PRINTING_TOLD)
        if any(map(PRINTS.fullmatch, said)):
            raise Refused("The controller carries out a file of its own: end that first.")

    def write(self, lines: Iterable[str]) -> None:
        """Write settings, one at a time; Answered when one is refused."""
        self.on_trial = True
        self._conversation.carry_out(list(lines))

    def store(self) -> None:
        """Store what is in use, and load that again, so that what it tells next is what it has stored.

        Raises NotStored when it can't.
        """
        if not self.stores:
            raise NotStored("This Marlin was built without EEPROM_SETTINGS: it stores nothing.")
        try:
            self._conversation.carry_out([STORE], time_s=STORING_S)
            self.load()
        except Answered as error:
            raise NotStored(str(error)) from error
        self.on_trial = False

    def load(self) -> None:
        """Load what is stored; Answered when it can't, which then uses its defaults."""
        self._conversation.carry_out([LOAD], time_s=STORING_S)

    def differing(self, wanted: Mapping[Figure, Fraction]) -> list[Figure]:
        """Return the figures that are others than wanted, as they were last read."""
        return [figure for figure, value in wanted.items() if not is_same(self.settings.number(*figure), value)]
