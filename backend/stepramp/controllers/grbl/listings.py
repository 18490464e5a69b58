"""What a controller lists of itself, heard twice where a lost byte would be kept: its lines have no checksum."""

from stepramp.controllers.grbl.conversation import Conversation
from stepramp.errors import Refused

MOST_READINGS = 5


class Listings:
    """The listings of a controller, each as it was last heard."""

    def __init__(self, conversation: Conversation) -> None:
        self._conversation = conversation
        self._last: dict[str, list[str]] = {}
        """By the line that asks for them."""

    def heard(self, line: str, time_s: float | None = None) -> list[str]:
        """Return what it says to a line; raises as Conversation.ask."""
        said = self._last[line] = self._conversation.ask(line, time_s)
        return said

    def agreed(self, line: str, time_s: float | None = None) -> list[str]:
        """Return the same once two readings, one after the other, agree; Refused when none do."""
        for _ in range(MOST_READINGS):
            before = self._last.get(line)
            if (said := self.heard(line, time_s)) == before:
                return said
        raise Refused(
            f"What the controller at {self._conversation.name} says to {line} is something else each time, as over a "
            "cable that loses bytes: it can't be backed up so."
        )
