"""A conversation with a Marlin: numbered lines, one at a time, each answered with ok or asked for again.

A line is sent again only with its number, so that none is carried out twice. Answers don't say to which line they are:
what is answered with words of its own is known by them, and whatever was said before it was answered before.
"""

import re
from collections.abc import Callable, Sequence
from math import inf
from time import monotonic

from stepramp.controllers.marlin.dialect import (
    AWAIT_REST,
    BANNER,
    BUSY,
    CHATTER,
    ENDSTOPS,
    ERROR,
    FIRST_LINE,
    IDENTIFY,
    KILL,
    OK,
    POSITION,
    QUICK_STOP,
    RESEND,
    START,
    TRANSFER_FAULT,
    UNKNOWN,
    Place,
    capability_of,
    firmware_of,
    marlin_version,
    numbered,
    place_of,
)
from stepramp.controllers.marlin.exchange import Answered, Exchange, Missed
from stepramp.controllers.marlin.refusals import busy, halted, no_axes, nobody, silent
from stepramp.controllers.restarts import restarted
from stepramp.errors import DeviceLost, Refused
from stepramp.link.connection import Connection
from stepramp.link.lines import Line, Lines

ANSWER_S = 1.2
"""So long an answer is waited for [s]: a listing takes 0.3 s."""
BUSY_S = 3.0
"""So long more, each time that it says it is busy, which it does every 2 s [s]."""
GREETING_S = 4.0
"""So long a board is given to start, its boot loader first [s]."""
STARTING_S = 10.0
"""The same of one that has told that it is Marlin, and still starts: it may show a picture first [s]."""
MOST_STARTS = 3
"""What tells that more often doesn't start, it babbles."""
CONNECTS_S = 4.0
"""So long one that says that it is busy is waited for while it is being connected [s]."""
KNOCK_S = 0.6
FIRST_S = 2.3
"""So long one that has told who it is has for its first answer, or to say that it is busy [s]."""
QUIET_S = 0.03
"""What it says after it has asked for a line again is waited for so long [s]."""
SURE_S = 0.8
"""A line that may be answered late is sent again when nothing is said to it for so long [s]."""
MOST_REPEATS = 3
PLACES_ASKED = 3
MOST_BEHIND = 8
"""So many lines before the last one it may ask for again; a number that has lost a digit is further away."""
MOST_LINES_AGAIN = 8
"""So often a line is sent again that arrives damaged."""
PLACE = re.compile(r"X:.* Count.*")
ENDSTOPS_TOLD = re.compile(r"(?:echo:)? ?Reporting endstop status.*")
HALTED = re.compile(r".*(?:Printer halted|kill\(\) called).*", re.IGNORECASE)


def _nothing() -> None:
    """Allow what is to be sent."""


class Conversation:
    """All that is said over an open port.

    give_way: called while an answer is waited for, for other calls that are more urgent. They may ask, too: then the
    answer that was waited for is given up.
    """

    def __init__(self, port: Connection, give_way: Callable[[float], None]) -> None:
        self._port = port
        self._lines = Lines(port, give_way, self._understand)
        self._exchange: Exchange | None = None
        self._number = 0
        """Of the next line."""
        self._begins = True
        self._banners = 0
        self._patient_until_s = 0.0
        """So long it may go on to say that it is busy."""
        self._may_set_out = False
        self._unproven: list[int] = []
        """Numbers of lines that seem to be answered; a line after them is taken only once they have arrived."""
        self._busy_until_s = 0.0
        self._starts = 0
        self.firmware: str | None = None
        self.capabilities: dict[str, bool] = {}
        """What it was built with, as far as it tells."""
        self.halted = False
        """It says that it takes nothing more until it is reset."""

    @property
    def name(self) -> str:
        """The name of the port."""
        return self._port.name

    @property
    def awaits_answer(self) -> bool:
        """Whether a line has been sent that isn't answered yet."""
        return self._exchange is not None and not self._exchange.is_over

    @property
    def may_set_out(self) -> bool:
        """Whether a motion was sent of which it isn't known whether it is planned already, or never will be."""
        return self._may_set_out

    @property
    def overtakes(self) -> bool:
        """Whether a quick stop may be obeyed before lines that came before it, as far as it tells."""
        return self.capabilities.get("EMERGENCY_PARSER", True)

    @property
    def is_busy(self) -> bool:
        """Whether it has said lately that it is busy."""
        return monotonic() < self._busy_until_s

    def begin(self) -> str:
        """Wait until a Marlin is there, and return its version. Nothing moves by it.

        Raises DeviceLost when nothing answers, Refused when something does that is no Marlin.
        """
        began_s = knock_s = monotonic()
        while self.firmware is None:
            is_starting = 0 < self._banners <= MOST_STARTS and not self.is_busy
            now_s, until_s = monotonic(), began_s + (STARTING_S if is_starting else GREETING_S)
            if now_s >= until_s:
                break
            if now_s >= knock_s:
                # The end of a line first: somebody may have left the beginning of one there.
                self._port.write(f"\n{IDENTIFY}\n".encode())
                knock_s = now_s + KNOCK_S
            self._lines.hear_until(lambda: self.firmware is not None, min(knock_s, until_s) - monotonic())
        if self.firmware is None:
            raise busy(self.name) if self.is_busy else nobody(self.name, has_heard=self._lines.has_heard)
        version = marlin_version(self.firmware)
        if version is None:
            raise Refused(f"What is at {self.name} is no Marlin but {self.firmware!r}.")
        self._begins, self._starts = False, 0
        self._lines.send(numbered(0, FIRST_LINE))
        self._number = 1
        self._patient_until_s = monotonic() + CONNECTS_S
        try:
            self.place(time_s=FIRST_S, repeats=0)
        except DeviceLost as error:
            raise (busy(self.name) if self.is_busy else error) from None
        return version

    def be_patient(self) -> None:
        """Wait from now on as long as it says that it is busy."""
        self._patient_until_s = inf

    def quick_stop(self) -> None:
        """Have it end all steps at once, whatever it is waited for; whether it has is to be seen from what it says."""
        self.say_unnumbered(QUICK_STOP)

    def kill(self) -> None:
        """Have it end everything until it is reset, heaters too."""
        self.say_unnumbered(KILL)

    def say_unnumbered(self, line: str) -> None:
        """Send a line, whatever is waited for, and whether it arrives or not."""
        self._port.write(f"\n{line}\n".encode())

    def place(self, time_s: float | None = None, repeats: int = MOST_REPEATS) -> Place:
        """Ask where the axes are. By then all that was sent before has been carried out, or was lost.

        Raises Refused when it tells that in another way, as a machine does whose motors aren't its axes.
        """
        # A line that has lost a letter on its way tells no places, either.
        for _ in range(PLACES_ASKED):
            said = self.ask(POSITION, PLACE, time_s=time_s, repeats=repeats)
            self._may_set_out = False
            found = next((place for place in map(place_of, reversed(said)) if place is not None), None)
            if found is not None and {"X", "Y", "Z"} <= set(found.counts):
                return found
        raise no_axes(self.name)

    def ask(
        self,
        line: str,
        needs: re.Pattern[str] | None = None,
        *,
        allowed: Callable[[], None] = _nothing,
        time_s: float | None = None,
        repeats: int = MOST_REPEATS,
    ) -> list[str]:
        """Send a line, and return what it says to that before its ok.

        needs: what one of these lines is. allowed: called before each time that it is sent; what it raises keeps it
        from going out. time_s: so long the answer is waited for, in place of ANSWER_S. repeats: so often it is sent
        again when nothing is said to it.
        Raises Answered when it refuses the line, DeviceLost when it says nothing, or was restarted meanwhile.
        """
        left, again = repeats, MOST_LINES_AGAIN
        before: Exchange | None = None
        while left >= 0 and again >= 0:
            allowed()
            exchange, number = self._send(line, needs, before)
            before = exchange
            self.hear_answer(time_s, is_patient=time_s is None or self._patient_until_s < inf)
            if self._exchange is not exchange:
                # Something more urgent has asked, and may have dropped the answer.
                allowed()
            elif exchange.is_over:
                return self._verdict(exchange)
            elif exchange.resend is None:
                if time_s is None and self.is_busy and monotonic() >= self._patient_until_s:
                    raise busy(self.name)
                left -= 1
            elif not number - MOST_BEHIND <= exchange.resend <= number + 1:
                # One that it can't want has lost a digit on its way: sent again, the line has it ask by the right one.
                again -= 1
                self._number, self._exchange = number, None
                self._hear_rest_of_fault()
            else:
                again -= 1
                if self._take_up(exchange, exchange.resend, number):
                    return self._verdict(exchange)
        raise silent(self.name)

    def carry_out(
        self, lines: Sequence[str], allowed: Callable[[], None] = _nothing, time_s: float | None = None
    ) -> list[str]:
        """Have lines carried out in their order, each once, and return all that it says to them.

        After it has asked for a line again an ok may belong to none. But a line is taken only once all before it have
        arrived, and so is a question after them. allowed, time_s: as in ask. Raises as ask.
        """
        # What is given long has had its time: whoever waits is to hear soon that nobody is there any more.
        repeats = MOST_REPEATS if time_s is None else 1
        said: dict[int, list[str]] = {}
        self._unproven, at = [], 0
        for _ in range(MOST_LINES_AGAIN):
            try:
                while at < len(lines):
                    said[at] = self.ask(lines[at], allowed=allowed, time_s=time_s, repeats=repeats)
                    self._unproven.append(self._number - 1)
                    at += 1
                self._ask_anything()
            except Missed as missed:
                at -= missed.count
            else:
                return [line for each in said.values() for line in each]
            finally:
                if at >= len(lines):
                    self._unproven = []
        raise silent(self.name)

    def start(self, line: str, needs: re.Pattern[str] | None = None) -> Exchange:
        """Send a line whose answer may take as long as motors move."""
        return self._send(line, needs, None)[0]

    def rests(self, time_s: float) -> bool:
        """Ask for everything to come to rest, and return whether it has within so long [s]."""
        self._unproven = []
        exchange = self.start(AWAIT_REST)
        if not (self.is_through(exchange, time_s) and exchange.is_over):
            return False
        self._unproven = [self._number - 1]
        try:
            self.place()
        except Missed:
            return False
        finally:
            self._unproven = []
        return True

    def hear_answer(self, time_s: float | None = None, *, is_patient: bool = False) -> bool:
        """Wait for the answer to the line that was sent last, and return whether it has come.

        is_patient: also for as long as it says that it is busy. Raises DeviceLost when it was restarted.
        """
        exchange = self._exchange
        until_s = monotonic() + (ANSWER_S if time_s is None else time_s)
        while True:
            patient_until_s = min(self._busy_until_s, self._patient_until_s) if is_patient else 0.0
            if (left_s := max(until_s, patient_until_s) - monotonic()) <= 0:
                break
            if self._lines.hear_until(lambda: self._exchange is not exchange or self._is_settled(exchange), left_s):
                break
        self._refuse_restarted()
        return exchange is None or exchange.is_over

    def is_through(self, exchange: Exchange, time_s: float) -> bool:
        """Wait for an answer, and return whether there is nothing more to wait for.

        That is so, too, once something else was asked, or the line has arrived damaged: then it isn't over. A line of
        which it isn't known whether it has arrived is sent again. If it had, whose ok comes next isn't known: a
        question that is answered in words then tells that it was carried out.
        """
        asked = exchange.proof or exchange
        if self._exchange is not asked:
            return True
        self.hear_answer(time_s)
        if self._exchange is asked and asked.resend is not None:
            was_taken = asked.resend > self._number
            self._number, self._exchange = asked.resend, None
            self._hear_rest_of_fault()
            if was_taken or asked is exchange.proof:
                exchange.proof = self.start(POSITION, PLACE)
        elif not asked.is_over and asked is exchange and monotonic() > exchange.sent_s + SURE_S:
            exchange.sent_s = monotonic()
            self._lines.send("\n" + numbered(self._number, exchange.line))
        exchange.is_over = asked.is_over
        return exchange.is_over or self._exchange is not (exchange.proof or exchange)

    def give_up(self, exchange: Exchange) -> None:
        """Wait for the answer to a line no more."""
        if self._exchange is (exchange.proof or exchange) and not exchange.is_over:
            self._number, self._exchange = self._number + 1, None

    def _send(self, line: str, needs: re.Pattern[str] | None, before: Exchange | None) -> tuple[Exchange, int]:
        """Send a line. before: how it was sent before, in vain."""
        if self.awaits_answer and self._exchange is not before:
            # What is given up for this has the number, whether it got there or not.
            self._number += 1
        self._exchange, number = Exchange(line, needs), self._number
        self._may_set_out = self._may_set_out or self._exchange.is_motion
        # What arrived before without its end mustn't become part of it: the sum of three times the same is that of one.
        self._lines.send(("\n" if before is not None else "") + numbered(number, line))
        return self._exchange, number

    def _take_up(self, exchange: Exchange, wanted: int, sent: int) -> bool:
        """Go on with the number that it asks for; return whether it has the line that was sent, and all is said of it.

        What is answered in words is to be asked again in any case. Raises Missed when earlier lines haven't arrived.
        """
        self._number, self._exchange = wanted, None
        self._hear_rest_of_fault()
        if missed := [number for number in self._unproven if number >= wanted]:
            self._unproven = [number for number in self._unproven if number < wanted]
            raise Missed(len(missed))
        return wanted > sent and not exchange.is_in_words

    def _ask_anything(self) -> None:
        """Ask what is answered in words: by then all that was sent before has been taken, or was lost."""
        self.ask(ENDSTOPS, ENDSTOPS_TOLD)
        self._may_set_out = False

    def _hear_rest_of_fault(self) -> None:
        """Wait until it is done with asking for a line again: it drops what comes until then."""
        self._lines.hear_until(lambda: False, QUIET_S)

    def _verdict(self, exchange: Exchange) -> list[str]:
        if exchange.is_unknown:
            raise Answered(exchange.line, "it knows no such command")
        if exchange.errors:
            raise Answered(exchange.line, exchange.errors[0].rstrip("."))
        return exchange.said

    def _is_settled(self, exchange: Exchange | None) -> bool:
        return exchange is None or exchange.is_over or exchange.resend is not None or self.halted

    def _understand(self, heard: Line) -> None:
        line = heard.text
        if heard.is_echo or not heard.is_whole:
            return
        if (firmware := firmware_of(line)) is not None:
            self.firmware = firmware
        if (capability := capability_of(line)) is not None:
            self.capabilities |= [capability]
        if START.fullmatch(line):
            self._starts += not self._begins
        elif BUSY.fullmatch(line):
            self._busy_until_s = monotonic() + BUSY_S
        elif HALTED.fullmatch(line):
            self.halted = True
        elif self._begins and BANNER.fullmatch(line):
            self._banners += 1
        elif CHATTER.fullmatch(line) or self._exchange is None or self._exchange.is_over:
            return
        else:
            self._note(self._exchange, line)

    def _note(self, exchange: Exchange, line: str) -> None:
        if OK.fullmatch(line):
            # After it has asked for a line again it says ok, too, or doesn't.
            if exchange.resend is None and (exchange.is_told or exchange.is_unknown):
                exchange.is_over, self._number = True, self._number + 1
                self._may_set_out = self._may_set_out and not exchange.is_motion
        elif (resend := RESEND.fullmatch(line)) is not None:
            exchange.resend = int(resend["number"])
        elif (unknown := UNKNOWN.fullmatch(line)) is not None:
            # What was sent without a number may have been damaged.
            exchange.is_unknown = exchange.is_unknown or exchange.line in unknown["line"]
        elif TRANSFER_FAULT.match(line) is None:
            if (error := ERROR.fullmatch(line)) is not None:
                exchange.errors.append(error["words"])
            exchange.said.append(line)

    def _refuse_restarted(self) -> None:
        if self._starts:
            raise restarted(self.name, is_connecting=self._patient_until_s < inf)
        if self.halted:
            raise halted(self.name)
