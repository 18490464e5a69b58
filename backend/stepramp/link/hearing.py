"""What comes in after questions, in bytes, for the families whose answers don't say to which question they are.

A family's conversation has one `Hearing` over its port. It says `note_question` before it writes one, then `hear`; an
answer that was given up it has to wait out, with `await_silence`, before what comes in can be taken for another one's.
"""

from collections.abc import Callable
from time import monotonic

from stepramp.link.connection import Connection

GIVE_WAY_S = 0.05
"""So long a more urgent call waits for what comes in at most [s]; an answer is mostly there by then."""
MOST_LATE = 10
"""So many pieces of late answers, or of noise, are waited for."""


class Hearing:
    """Hears answers over an open port. Not for two threads at once.

    give_way: called while something is waited for, for other calls that are more urgent. They may ask, too: then what
    was waited for is theirs.
    """

    def __init__(self, port: Connection, give_way: Callable[[float], None]) -> None:
        self._port = port
        self._give_way = give_way
        self._asked = 0
        self._answer_due_s = 0.0
        """Until when the last question is usually answered, by the monotonic clock [s]."""

    @property
    def asked(self) -> int:
        """How many questions there were."""
        return self._asked

    def note_question(self, time_s: float) -> None:
        """Note that something is asked now, which is usually answered within so long [s]."""
        self._asked += 1
        self._answer_due_s = monotonic() + time_s

    def hear(self, most: int, time_s: float) -> bytes:
        """Return what comes in until there are so many bytes, time is up [s], or something more urgent has asked."""
        heard, asked, now_s = b"", self._asked, monotonic()
        deadline_s, give_way_s = now_s + time_s, now_s + GIVE_WAY_S
        while len(heard) < most and self._asked == asked and now_s < deadline_s:
            heard += self._port.read(min(deadline_s, give_way_s) - now_s)
            now_s = monotonic()
            if now_s >= give_way_s and len(heard) < most:
                self._give_way(0.0)
                now_s = monotonic()
                give_way_s = now_s + GIVE_WAY_S
        return heard

    def await_silence(self, quiet_s: float) -> None:
        """Drop what comes in until nothing does for so long [s], after the last answer is due, or it never ends."""
        wait_s = max(0.0, self._answer_due_s - monotonic()) + quiet_s
        for _ in range(MOST_LATE):
            asked = self._asked
            heard = self.hear(1, wait_s)
            # Also when pieces come so fast that nothing else gives way.
            self._give_way(0.0)
            if not heard and self._asked == asked:
                return
            wait_s = quiet_s
