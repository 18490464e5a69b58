"""A conversation with a TMCL module: each command is answered, with a checksum, and asked again when it isn't."""

import re
from collections.abc import Callable
from time import monotonic

from stepramp.controllers.tmcl.wire import FRAME_BYTES, MODULE_ADDRESS, Command, Reply, Status, reply_of, request, told
from stepramp.errors import DeviceLost, Refused
from stepramp.link.connection import Connection
from stepramp.link.hearing import Hearing

ANSWER_S = 0.2
"""So long an answer is waited for [s]: at 9600 baud command and answer take 19 ms, a module may pause before that, and
a USB adapter may keep what it hears 16 ms."""
STORING_S = 0.5
"""The same of what writes an EEPROM."""
MOST_REPEATS = 3
"""So often what a disturbed line has swallowed or damaged is said again."""
MOST_GREETINGS = 5
_NAME = re.compile(rb"(?P<number>\d{4})V(?P<major>\d)\.?(?P<minor>\d\d)")


class Denied(Refused):
    """A module has answered that it doesn't do what it was told. status: its own word."""

    def __init__(self, status: int, command: Command, kind: int) -> None:
        self.status = status
        super().__init__(f"The module refuses {command.name} {kind}: {told(status)}.")


def _nothing() -> None:
    """Allow what is to be sent."""


class Conversation:
    """All that is said over an open port.

    give_way: called before each question, and while an answer or silence is waited for, for other calls that are more
    urgent. They may ask, too.
    """

    def __init__(self, port: Connection, give_way: Callable[[float], None]) -> None:
        self.name = port.name
        self._port = port
        self._give_way = give_way
        self._hearing = Hearing(port, give_way)
        self._unanswered: set[int] = set()
        """Commands whose answers may still come: in their order, and they don't say to which of the same command."""

    def begin(self) -> tuple[int, str]:
        """Find out whether a module is there; return its number and its firmware's version. Nothing moves by it.

        Raises DeviceLost when nothing answers, Refused when something does that is no module.
        """
        frame = request(Command.VERSION, kind=1)
        heard = False
        for _ in range(MOST_GREETINGS):
            self._give_way(0.0)
            heard = bool(self._port.pending()) or heard
            reply, noise = self._ask_once(frame, _nothing, ANSWER_S)
            if reply is not None and reply.status == Status.OK:
                number, major, minor = reply.value % 2**32 >> 16, reply.value >> 8 & 0xFF, reply.value & 0xFF
                return (number, f"{major}.{minor:02}") if number else self._ask_name()
            heard = heard or noise
        if heard:
            raise Refused(
                f"Something talks at {self.name}, but it is no TMCL module of the serial address {MODULE_ADDRESS}, or "
                "its baud rate is another one."
            )
        raise DeviceLost(
            f"Nothing answers at {self.name} as a TMCL module does: has it power, are its serial address "
            f"{MODULE_ADDRESS} and its baud rate 9600, as it comes? A controller of another family is to be connected "
            "as that."
        )

    def tell_at_once(self, command: Command, motor: int, time_s: float) -> None:
        """Send a command whatever is still to be answered, and give it so long for its own answer [s].

        Whether it was answered has to be seen from what is asked next.
        """
        self._ask_once(request(command, 0, motor), _nothing, time_s)

    def ask(
        self,
        command: Command,
        kind: int = 0,
        motor: int = 0,
        value: int = 0,
        *,
        allowed: Callable[[], None] = _nothing,
    ) -> int:
        """Send a command, and return the value of its answer; repeated until it is answered: so it may come twice.

        allowed: called before each time that it is sent; what it raises keeps it from going out.
        Raises Denied when the module answers that it doesn't do it, DeviceLost when it doesn't answer.
        """
        frame = request(command, kind, motor, value)
        time_s = STORING_S if command is Command.STAP else ANSWER_S
        for _ in range(1 + MOST_REPEATS):
            self._give_way(0.0)
            reply = self._answer(frame, allowed, time_s)
            if reply is None or reply.is_told_damage:
                continue
            if reply.status != Status.OK:
                raise Denied(reply.status, command, kind)
            return reply.value
        raise DeviceLost(f"The TMCL module at {self.name} does not answer.")

    def _ask_name(self) -> tuple[int, str]:
        """Return what an older firmware tells as text only: eight characters without a checksum, asked for twice."""
        names = set()
        for _ in range(2):
            self._hearing.await_silence(ANSWER_S)
            frame = request(Command.VERSION)
            self._note_question(frame, ANSWER_S)
            self._port.write(frame)
            heard = self._hearing.hear(2 * FRAME_BYTES, ANSWER_S).removeprefix(frame)
            found = _NAME.search(heard)
            names.add(
                None if found is None else (int(found["number"]), f"{int(found['major'])}.{found['minor'].decode()}")
            )
        name = names.pop()
        if name is None or names:
            raise Refused(f"The TMCL module at {self.name} doesn't tell which one it is: nothing was sent to it.")
        return name

    def _answer(self, frame: bytes, allowed: Callable[[], None], time_s: float) -> Reply | None:
        """Ask, and return the answer; None when it doesn't come.

        It is asked anew when something more urgent has asked meanwhile, and so dropped the answer.
        """
        while True:
            is_doubtful = frame[1] in self._unanswered
            if is_doubtful:
                self._hearing.await_silence(ANSWER_S)
            asked = self._hearing.asked
            reply, _ = self._ask_once(frame, allowed, time_s)
            if self._hearing.asked == asked + 1:
                break
        if reply is not None and is_doubtful:
            # One that was given up mustn't be taken for that to the next question.
            self._hearing.await_silence(ANSWER_S)
            self._unanswered.clear()
        return reply

    def _ask_once(self, frame: bytes, allowed: Callable[[], None], time_s: float) -> tuple[Reply | None, bool]:
        """Ask, and return the answer, or None; and whether anything was heard."""
        self._port.pending()  # Noise.
        allowed()
        is_doubtful = frame[1] in self._unanswered
        self._note_question(frame, time_s)
        self._port.write(frame)
        asked, heard, deadline_s = self._hearing.asked, b"", monotonic() + time_s
        while self._hearing.asked == asked and (left_s := deadline_s - monotonic()) > 0:
            more = self._hearing.hear(1, left_s)
            # What can't begin an answer any more, as noise without end, isn't looked at again.
            begun = max(0, len(heard) - FRAME_BYTES + 1)
            heard += more
            reply = _answer_in(heard[begun:], frame)
            if reply is not None and not is_doubtful and not reply.is_told_damage:
                # What was asked before was answered before, or never will be.
                self._unanswered.clear()
            if reply is not None:
                return reply, True
        return None, bool(heard)

    def _note_question(self, frame: bytes, time_s: float) -> None:
        self._hearing.note_question(time_s)
        self._unanswered.add(frame[1])


def _answer_in(heard: bytes, frame: bytes) -> Reply | None:
    """Return the answer to a command among what was heard; None while there is none.

    There may be what others say on the line, the end of an answer that was given up, and, with a converter of RS-485
    that hears itself, the command.
    """
    for place in range(len(heard) - FRAME_BYTES + 1):
        window = heard[place : place + FRAME_BYTES]
        reply = None if window == frame else reply_of(window)
        if reply is None or reply.address != MODULE_ADDRESS:
            continue
        if reply.command == frame[1] or reply.is_told_damage:
            return reply
    return None
