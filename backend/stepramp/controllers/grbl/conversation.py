"""A conversation with a grbl: lines, one at a time, each of which it answers, and bytes that it obeys in between."""

from collections.abc import Callable
from time import monotonic

from stepramp.controllers.grbl.dialect import (
    LONGEST_LINE,
    RESET,
    STATUS,
    Banner,
    Report,
    State,
    banner_of,
    error_words,
    report_of,
    verdict_of,
)
from stepramp.controllers.restarts import restarted
from stepramp.errors import DeviceLost, Refused
from stepramp.link.connection import Connection
from stepramp.link.lines import Line, Lines

ANSWER_S = 1.0
"""So long an answer is waited for [s]: a setting takes 17 ms, a listing 50 ms."""
GREETING_S = 3.5
"""So long a board is given to start, its boot loader first [s]."""
KNOCK_S = 0.5
MOST_REPEATS = 3
UNREADABLE = 7
"""The error of what is broken in its EEPROM. In the midst of a listing it is told besides, and the listing goes on."""
LISTINGS_OF_PARTS = ("$#", "$N")


class Answered(Refused):
    """A grbl has refused a line. code: as it said. after: what comes of others that it has taken before, in words."""

    def __init__(self, line: str, code: int, after: str = "") -> None:
        super().__init__(f"The controller refuses {line!r}: {error_words(code)}.{after}")
        self.line, self.code = line, code


class _Exchange:
    """What is said to a line."""

    def __init__(self, line: str) -> None:
        self.is_listing = line in LISTINGS_OF_PARTS
        self.said: list[str] = []
        self.error: int | None = None
        self.is_over = False


class Conversation:
    """All that is said over an open port.

    give_way: called while an answer is waited for, for other calls that are more urgent. They may
    send real-time commands, and hear; not lines. called: what people call such a firmware.
    """

    def __init__(self, port: Connection, give_way: Callable[[float], None], called: str = "grbl") -> None:
        self._port = port
        self._called = called
        self._lines = Lines(port, give_way, self._understand)
        self._exchange: _Exchange | None = None
        self._report: Report | None = None
        self._reports = self._starts = self._own_starts = 0
        self._is_connecting = True
        self.banner: Banner | None = None
        """Of its last start, as far as it was heard."""
        self.has_started = False
        """It was heard to start as the port was opened. One that goes on answers first, and some greet after that."""
        self.alarm: int | None = None
        """Code of the last alarm since it was started; None for none."""

    @property
    def name(self) -> str:
        """The name of the port."""
        return self._port.name

    @property
    def awaits_answer(self) -> bool:
        """Whether a line has been sent that isn't answered yet."""
        return self._exchange is not None and not self._exchange.is_over

    def begin(self) -> None:
        """Wait until a grbl is there. Nothing moves by it.

        Raises DeviceLost when nothing answers, Refused when something does that is no grbl.
        """
        deadline_s, knock_s = monotonic() + GREETING_S, monotonic()
        while (now_s := monotonic()) < deadline_s:
            if now_s >= knock_s:
                self.send(STATUS)
                knock_s = now_s + KNOCK_S
            self._lines.hear_until(lambda: bool(self._starts or self._reports), min(knock_s, deadline_s) - monotonic())
            if self._starts or self._reports:
                # A board with USB of its own answers first, and says then that it has started.
                self._lines.hear_until(lambda: bool(self._starts), KNOCK_S / 2)
                self._own_starts = self._starts
                return
        if self._lines.has_heard:
            raise Refused(
                f"Something talks at {self.name}, but it is no {self._called}, or its baud rate is another one."
            )
        raise DeviceLost(
            f"Nothing answers at {self.name} as {self._called} does: has it power, is its baud rate 115200? A "
            "controller of another family is to be connected as that."
        )

    def end_connecting(self) -> None:
        """Note that what is there is known: if it starts anew from now on, it forgets where it is."""
        self._is_connecting = False

    def send(self, command: bytes) -> None:
        """Send real-time commands."""
        self._port.write(command)

    def look(self) -> Report:
        """Return how it fares; DeviceLost when it doesn't say, or was restarted by somebody else."""
        for _ in range(1 + MOST_REPEATS):
            before = self._reports
            self.send(STATUS)
            if self._lines.hear_until(self._reports_beyond(before), ANSWER_S / 2):
                break
            self._refuse_restarted()
        else:
            raise self._lost()
        self._refuse_restarted()
        assert self._report is not None
        return self._report

    def ask(self, line: str, time_s: float | None = None) -> list[str]:
        """Send a line, and return what it says to that before its ok, in time [s]; None: in ANSWER_S.

        Raises Answered when it refuses the line, DeviceLost when it says nothing, or was restarted meanwhile.
        """
        assert len(line) <= LONGEST_LINE
        self._exchange = exchange = _Exchange(line)
        self._lines.send(line)
        self.hear_answer(time_s)
        self._refuse_restarted()
        if exchange.error is not None:
            raise Answered(line, exchange.error)
        if not exchange.is_over:
            raise self._lost()
        return exchange.said

    def hear_answer(self, time_s: float | None = None) -> bool:
        """Wait for the answer to a line that was sent, if there is one, and return whether it has come."""
        return self._lines.hear_until(lambda: not self.awaits_answer, ANSWER_S if time_s is None else time_s)

    def reset(self) -> None:
        """Have it start anew, which drops what it was told and stops what moves at once; DeviceLost when it doesn't."""
        for _ in range(1 + MOST_REPEATS):
            before, self._own_starts = self._starts, self._starts + 1
            self.send(RESET)
            if self._lines.hear_until(self._starts_beyond(before), ANSWER_S / 2):
                self._own_starts = self._starts
                return
        raise self._lost()

    def _reports_beyond(self, count: int) -> Callable[[], bool]:
        return lambda: self._reports > count

    def _starts_beyond(self, count: int) -> Callable[[], bool]:
        return lambda: self._starts > count

    def _understand(self, heard: Line) -> None:
        line = heard.text
        if heard.is_echo or not heard.is_whole:
            return
        if (report := report_of(line)) is not None:
            self._report, self._reports = report, self._reports + 1
            if report.state is not State.ALARM:
                self.alarm = None
            elif report.part:
                self.alarm = report.part
        elif (banner := banner_of(line)) is not None:
            self.has_started = self.has_started or not (self._starts or self._reports)
            self.banner, self.alarm = banner, None if self._starts == self._own_starts else self.alarm
            self._starts += 1
            self._end_exchange(None)
        elif (verdict := verdict_of(line)) is not None:
            if verdict.word == "ALARM":
                self.alarm = verdict.code
            else:
                self._end_exchange(verdict.code if verdict.word == "error" else None)
        elif self.awaits_answer and self._exchange is not None:
            self._exchange.said.append(" " * heard.indent + line)

    def _end_exchange(self, error: int | None) -> None:
        if self._exchange is not None and not self._exchange.is_over:
            if error == UNREADABLE and self._exchange.is_listing:
                return
            self._exchange.error, self._exchange.is_over = error, True

    def _refuse_restarted(self) -> None:
        if self._starts > self._own_starts:
            raise restarted(self.name, is_connecting=self._is_connecting)

    def _lost(self) -> DeviceLost:
        return DeviceLost(f"The controller at {self.name} does not answer.")
