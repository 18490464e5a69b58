"""How a Klipper is stopped, and that nothing that it was told before goes on afterwards.

It can't be told to slow down: what is in its plan is played. So the plan is kept short (see moves.py), a stop adds
nothing to it any more, and it ends at rest. Only the emergency stop ends what is planned; Klipper is shut down by it.
"""

from contextlib import suppress
from time import monotonic

from stepramp.controllers.contract import AnswerUnknown
from stepramp.controllers.klipper.conversation import EMERGENCY, Answered, Conversation
from stepramp.controllers.klipper.seen import SHUTDOWN
from stepramp.errors import DeviceLost

SCRIPTS_S = 1.5
"""So long G-code that was sent is waited for [s]: what waits its turn for longer might set out much later."""
SHUT_DOWN_S = 2.0
"""So long an emergency stop is given to be seen [s]."""


class Stopping:
    """Stops a Klipper, and counts how often: what was asked before a stop is not carried out after it."""

    def __init__(self, conversation: Conversation) -> None:
        self._conversation = conversation
        self._count = 0

    @property
    def count(self) -> int:
        """How many stops there were so far."""
        return self._count

    def note(self) -> None:
        """Count a stop: nothing that was asked before it is sent any more."""
        self._count += 1

    def refuse_stopped(self, count: int) -> None:
        """Raise AnswerUnknown when a stop came since there were so many."""
        if self._count != count:
            raise AnswerUnknown("A stop came first: what was asked before it is not carried out.")

    def let_end(self) -> None:
        """Wait until what was sent is in Klipper's plan; what isn't in time is dropped, by an emergency stop."""
        if not self._conversation.hear_scripts(SCRIPTS_S):
            self.shut_down()

    def shut_down(self) -> None:
        """Have Klipper make no further step, and drop what waits; DeviceLost when it isn't seen to have done so."""
        with suppress(Answered):
            # What has failed by itself is shut down already.
            self._conversation.ask(EMERGENCY)
        deadline_s = monotonic() + SHUT_DOWN_S
        while self._conversation.look().webhooks.state != SHUTDOWN:
            if monotonic() > deadline_s:
                raise DeviceLost(f"Klipper at {self._conversation.name} doesn't shut down.")

    def give_up(self) -> None:
        """Have it shut down, whether it hears or not: what it was told isn't answered."""
        with suppress(DeviceLost, Answered):
            self._conversation.ask(EMERGENCY)
