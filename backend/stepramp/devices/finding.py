"""Which family a controller is of, as far as it says so by itself when its port is opened: nothing is sent to it."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from time import monotonic

from stepramp.controllers.families import Family, Open
from stepramp.errors import Refused
from stepramp.link.lines import LineSplitter
from stepramp.link.remote_ports import RemotePorts

LISTEN_S = 2.3
"""So long a board is given at each rate to start, its boot loader first, and to say what it is [s]."""
MOST_LINES = 5
"""So many lines of what was heard are told."""
_SLICE_S = 0.05
_LEGIBLE = re.compile(r"[\w .,:;'()\[\]/$!-]{4,}", re.ASCII)
"""What noise, or another rate, hardly ever makes."""


@dataclass(frozen=True)
class Found:
    """What was heard at a port."""

    family: str | None
    """Name of the family that the controller there has named; None: it has named none that is known."""
    heard: list[str]
    """The line that named it, or else the first that were legible."""


def find_family(port: str, families: Iterable[Family], remote_ports: RemotePorts) -> Found:
    """Open a port, which starts most boards anew, and listen to what the controller says of itself.

    families: those that it may be of; each rate at which some of them start with their name is listened to in turn.
    Raises as an Open does, and Refused where no such family can be there.
    """
    named = [each for each in families if each.names_itself is not None]
    if not named:
        raise Refused(f"No family that can be at {port} says what it is before it is asked: say which one it is.")
    legible: list[str] = []
    for opens in dict.fromkeys(each.open for each in named):
        of_rate = [each for each in named if each.open == opens]
        if (found := _listen(port, opens, of_rate, remote_ports, legible)) is not None:
            return found
    return Found(None, legible)


def _listen(
    port: str, opens: Open, families: Iterable[Family], remote_ports: RemotePorts, legible: list[str]
) -> Found | None:
    """Return whom a line names, adding to what was legible; None when none does in time."""
    connection, splitter = opens(port, _send_nothing, remote_ports), LineSplitter()
    try:
        deadline_s = monotonic() + LISTEN_S
        while monotonic() < deadline_s:
            for line in splitter.feed(connection.read(_SLICE_S)):
                for family in families:
                    if family.names_itself is not None and family.names_itself(line.text):
                        return Found(family.name, [line.text])
                if line.is_whole and _LEGIBLE.fullmatch(line.text) and len(legible) < MOST_LINES:
                    legible.append(line.text)
    finally:
        connection.close()
    return None


def _send_nothing() -> None:
    raise AssertionError("Who only listens sends nothing.")
