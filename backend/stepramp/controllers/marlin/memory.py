"""What a Marlin keeps: its settings, read, written one at a time, stored, and proven to be stored by loading them."""

import re
from collections.abc import Callable, Iterable, Mapping
from fractions import Fraction
from typing import TypeVar

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
from stepramp.controllers.marlin.settings import STEPS_PER_MM, Settings, is_same
from stepramp.errors import Refused

LISTED = re.compile(r"(?:echo:)?\s*M92 .*")
FIRMWARE = re.compile(r"FIRMWARE_NAME:.*")
PRINTING_TOLD = re.compile(f"{PRINTS.pattern}|{NOT_PRINTING.pattern}")
STORING_S = 6.0
"""So long storing may take [s]: an EEPROM takes 3.4 ms a byte."""
LISTINGS = ((IDENTIFY, FIRMWARE), (SETTINGS, LISTED))
MOST_READINGS = 5
T = TypeVar("T")
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
        self._tells_scales: bool | None = None
        """Whether it tells its steps per mm when it is asked for these alone, as from 2.0 on; None: not asked yet."""

    @property
    def stores(self) -> bool:
        """Whether it was built to store settings."""
        return self._conversation.capabilities.get("EEPROM", True)

    def learn(self) -> None:
        """Read the settings in use; Refused for those that are told in inches, or by a Marlin that is too old."""
        self.settings = self._surely(lambda: Settings.of(self._conversation.ask(SETTINGS, LISTED)), self.settings)
        if self.settings.is_in_inches:
            raise Refused(
                f"The Marlin at {self._conversation.name} counts in inches (G20): say G21 at the machine first."
            )
        if self.settings.is_of_marlin_1_0:
            raise Refused(
                f"The Marlin at {self._conversation.name} is older than 1.1: with M204 it sets S for all moves, and T "
                "for retracts, where later ones take T for travel. Marlin is known from 1.1 on."
            )

    def tells_other_scales(self) -> bool:
        """Ask for the steps per mm, and return whether they seem to be others than were read."""
        if self._tells_scales is None:
            # An older one says ok, and does nothing.
            said = self._conversation.ask(STEPS_PER_MM)
            self._tells_scales = any(map(LISTED.fullmatch, said))
        elif self._tells_scales:
            said = self._conversation.ask(STEPS_PER_MM, LISTED)
        if not self._tells_scales:
            said = self._conversation.ask(SETTINGS, LISTED)
        return Settings.of(said).scales != self.settings.scales

    def everything(self) -> str:
        """Return all that can be read, as it was told."""

        def told() -> str:
            asked = [(f"; {listing}", *self._conversation.ask(listing, needs)) for listing, needs in LISTINGS]
            return "\n".join(line for lines in asked for line in lines) + "\n"

        return self._surely(told)

    def _surely(self, read: Callable[[], T], before: T | None = None) -> T:
        """Read until two readings in a row agree: what it tells has no checksum, and a lost byte is another number.

        before: the last reading, if there was one.
        """
        for _ in range(MOST_READINGS):
            told = read()
            if told == before:
                return told
            before = told
        raise Refused(
            f"The serial line to {self._conversation.name} is disturbed: what the controller tells of its settings is "
            "another thing each time."
        )

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
