"""How a Marlin is stopped, and that nothing that it was told before goes on afterwards."""

from collections.abc import Callable
from contextlib import suppress

from stepramp.controllers.contract import AnswerUnknown
from stepramp.controllers.marlin.conversation import Conversation
from stepramp.controllers.marlin.dialect import ABSOLUTE, Place
from stepramp.errors import DeviceLost, Refused

STOPPED_S = 2.5
"""So long it may take to say where it has stopped [s]: for 1 s, or twice that, it takes no moves and says nothing."""
PROVEN_S = 1.5
"""So long it may take then to say that everything rests [s]."""
TRIES = 3


class Busy(Refused):
    """A Marlin is busy with something that keeps it from answering."""


class Stopping:
    """Stops a Marlin, and counts how often: what was asked before a stop is not carried out after it.

    Its only stop is the quick stop: all steps end at once, whichever axes are named.
    stopped: called with where it has stopped.
    """

    def __init__(self, conversation: Conversation, stopped: Callable[[Place], None]) -> None:
        self._conversation = conversation
        self._stopped = stopped
        self._count = 0
        self.may_be_relative = False
        """It was told to take ways as relative (G91), and hasn't surely been told to take places again."""

    @property
    def count(self) -> int:
        """How many stops there were so far."""
        return self._count

    def refuse_stopped(self, count: int) -> None:
        """Raise AnswerUnknown when a stop came since there were so many."""
        if self._count != count:
            raise AnswerUnknown("A stop came first: what was asked before it is not carried out.")

    def stop(self) -> None:
        """Make no further step. Raises DeviceLost when it doesn't answer, Refused when something moves on.

        A line that was sent before may be carried out after a quick stop: with an emergency parser that overtakes it. A
        question that comes after it is answered only once a move in it is planned; that begins 0.1 s later, and a
        second quick stop ends it before. Without such a parser the quick stop's own line has its turn after it, too.
        What was cut short may have left it relative: whoever talks to it next expects places.
        """
        self._count += 1
        try:
            self._stop()
        except DeviceLost:
            self._say_places()
            raise

    def leave_relative(self) -> None:
        """Have it take places again (G90), where it may take ways; moves nothing."""
        if self.may_be_relative:
            self._conversation.carry_out([ABSOLUTE])
            self.may_be_relative = False

    def halt(self) -> None:
        """Stop; where it doesn't, have it end everything until it is reset, heaters too, as the last resort."""
        try:
            self.stop()
        except Busy:
            raise
        except (DeviceLost, Refused):
            with suppress(DeviceLost):
                self._conversation.kill()
            raise

    def give_up(self) -> None:
        """Have it stop, whether it hears or not: what it was told isn't answered."""
        with suppress(DeviceLost):
            self._conversation.quick_stop()
            self._conversation.quick_stop()
        self._say_places()

    def _stop(self) -> None:
        if self._conversation.may_set_out and self._conversation.overtakes:
            self._stop_at_once()
        for _ in range(TRIES):
            self._stop_at_once()
            # A quick stop may be lost on its way: that everything rests is told by itself.
            if self._conversation.rests(PROVEN_S):
                self._stopped(self._conversation.place())
                with suppress(Refused):
                    self.leave_relative()
                return
        raise Refused(
            f"The controller at {self._conversation.name} doesn't stop when it is told to: cut the power of its motors."
        )

    def _say_places(self) -> None:
        """Have it take places again, whether it hears or not."""
        if self.may_be_relative:
            with suppress(DeviceLost):
                self._conversation.say_unnumbered(ABSOLUTE)

    def _stop_at_once(self) -> None:
        """Say that it is to stop, until it answers what is asked after that."""
        for left in reversed(range(TRIES)):
            self._conversation.quick_stop()
            try:
                self._conversation.place(time_s=STOPPED_S, repeats=0)
            except DeviceLost:
                if self._conversation.is_busy:
                    raise Busy(
                        f"The controller at {self._conversation.name} was told to stop. It is busy, as while it heats, "
                        "and doesn't say yet whether it has."
                    ) from None
                if not left:
                    raise
            else:
                return
