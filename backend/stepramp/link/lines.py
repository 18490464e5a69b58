"""Lines of text out of the pieces in which bytes come, for the families whose controllers speak in lines.

A family's conversation has one `Lines` over its port. It says `send`, and then `hear_until` what it waits for is so;
each line that comes meanwhile is handed to its `understand`, whoever was waiting: a stop in between hears, too.

    lines = Lines(port, give_way, self._understand)
    lines.send("$$")
    if not lines.hear_until(lambda: self._is_answered, ANSWER_S): ...
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from time import monotonic

from stepramp.link.connection import Connection

LONGEST_LINE = 1024
"""What comes without an end of line for longer is no text of a controller's [bytes]."""
GIVE_WAY_S = 0.05
"""So long a more urgent call waits for what comes in at most [s]."""
MOST_LINES = 10_000
"""So many lines without the one that is waited for are chatter: no listing is so long."""
_ENDS = re.compile(rb"\r\n|\r|\n")
_CONTROLS = {code: f"\\x{code:02x}" for code in (*range(0x20), 0x7F) if chr(code) != "\t"}


@dataclass(frozen=True)
class Line:
    """A line that has come in, without its end and the blanks around it.

    What is no UTF-8, and what controls a terminal, stands there as a backslash, x and its number.
    """

    text: str
    is_whole: bool = True
    """It is not longer than a line may be; of a longer one there is but its beginning."""
    is_echo: bool = False
    """It is what was sent last, come back."""
    indent: int = field(default=0, compare=False)
    """How many blanks there were before it: in some texts they mean something."""


class LineSplitter:
    """Finds lines in bytes, however they are cut: each ends with CR, LF or both, empty ones are left out.

    NUL says nothing, as ASCII has it: many boards send some while they start.
    """

    def __init__(self, longest: int = LONGEST_LINE) -> None:
        self._longest = longest
        self._begun = b""
        self._is_whole = True

    def feed(self, data: bytes) -> list[Line]:
        """Return the lines that these bytes have brought to their end."""
        # Of CR and LF the second ends an empty line, wherever they are cut.
        *ended, begun = _ENDS.split(data.replace(b"\0", b""))
        lines = []
        for each in ended:
            self._go_on(each)
            if text := _text(self._begun):
                indent = len(self._begun) - len(self._begun.lstrip(b" "))
                lines.append(Line(text, self._is_whole, indent=indent))
            self._begun, self._is_whole = b"", True
        self._go_on(begun)
        return lines

    def _go_on(self, data: bytes) -> None:
        self._is_whole = self._is_whole and len(self._begun) + len(data) <= self._longest
        self._begun += data[: self._longest - len(self._begun)]


class Lines:
    """What is said in lines over an open port. Not for two threads at once.

    give_way: called between reads, for other calls that are more urgent. understand: given each line that comes in.
    """

    def __init__(self, port: Connection, give_way: Callable[[float], None], understand: Callable[[Line], None]) -> None:
        self._port = port
        self._give_way = give_way
        self._understand = understand
        self._splitter = LineSplitter()
        self._sent: str | None = None
        """What was sent last, as long as it hasn't come back."""
        self.has_heard = False
        """Whether anything has come in, lines or not."""

    def send(self, line: str) -> None:
        """Send a line; DeviceLost when the port is gone.

        Only the one sent last is known as an echo: earlier ones may be told again in earnest, as settings in a listing.
        """
        self._sent = line.strip()
        self._port.write(f"{line}\n".encode())

    def hear_until(self, is_so: Callable[[], bool], time_s: float) -> bool:
        """Take what comes in until something is so, time is up [s], or it is but chatter; return whether it is so.

        Raises DeviceLost when the port is gone, and what giving way raises.
        """
        now_s = monotonic()
        deadline_s, heard = now_s + time_s, 0
        while not is_so() and now_s < deadline_s and heard <= MOST_LINES:
            heard += self._take(self._port.read(min(GIVE_WAY_S, deadline_s - now_s)))
            if not is_so():
                self._give_way(0.0)
            now_s = monotonic()
        return is_so()

    def listen(self) -> None:
        """Take what has come in by now, without waiting for more."""
        self._take(self._port.pending())

    def _take(self, data: bytes) -> int:
        """Hand on the lines that have come to their end, and return how many there were."""
        self.has_heard = self.has_heard or bool(data)
        lines = self._splitter.feed(data)
        for line in lines:
            self._understand(self._known(line))
        return len(lines)

    def _known(self, line: Line) -> Line:
        if line.text != self._sent:
            return line
        self._sent = None
        return Line(line.text, line.is_whole, is_echo=True, indent=line.indent)


def _text(data: bytes) -> str:
    return data.decode("utf-8", "backslashreplace").translate(_CONTROLS).strip()
