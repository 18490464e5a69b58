"""A line that is said to a Marlin, and what it says to that."""

import re
from time import monotonic

from stepramp.controllers.marlin.dialect import MOTION
from stepramp.errors import Refused


class Answered(Refused):
    """A Marlin has refused a line."""

    def __init__(self, line: str, words: str) -> None:
        super().__init__(f"The controller refuses {line!r}: {words}.")


class Missed(Refused):
    """Lines haven't arrived, though they seemed to be answered. count: how many of the last ones."""

    def __init__(self, count: int) -> None:
        super().__init__("The serial line is disturbed: what was sent hasn't arrived.")
        self.count = count


class Exchange:
    """A line, and what is said to it. needs: words that its answer has, whichever ok comes before them."""

    def __init__(self, line: str, needs: re.Pattern[str] | None) -> None:
        self.line, self._needs = line, needs
        self.said: list[str] = []
        self.errors: list[str] = []
        self.resend: int | None = None
        self.begun_s = self.sent_s = monotonic()
        self.proof: Exchange | None = None
        """What was asked after it, once it was told to have arrived."""
        self.is_over = self.is_unknown = False

    @property
    def is_told(self) -> bool:
        """Whether what it needs was said."""
        return self._needs is None or any(map(self._needs.fullmatch, self.said))

    @property
    def is_motion(self) -> bool:
        """Whether it has axes move."""
        return self.line.startswith(MOTION)

    @property
    def is_in_words(self) -> bool:
        """Whether its answer is known by its words."""
        return self._needs is not None
