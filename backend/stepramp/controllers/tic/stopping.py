"""How a Tic is stopped, and that it has understood."""

from stepramp.controllers.contract import AnswerUnknown
from stepramp.controllers.tic.conversation import MOST_REPEATS, Conversation
from stepramp.controllers.tic.memory import Memory
from stepramp.controllers.tic.variables import NEUTRAL, Flag, Input, InputState, PlanningMode
from stepramp.controllers.tic.wire import Quick, Write, quick, write
from stepramp.errors import Refused

SLOW_DOWN = write(Write.TARGET_VELOCITY, 0)
HALT = quick(Quick.HALT_AND_HOLD)


class Stopping:
    """Stops a Tic, and counts how often: what was asked before a stop is not carried out after it."""

    def __init__(self, conversation: Conversation, memory: Memory, port_name: str) -> None:
        self._conversation = conversation
        self._memory = memory
        self._port_name = port_name
        self._count = 0

    @property
    def count(self) -> int:
        """How many stops there were so far."""
        return self._count

    def refuse_stopped(self, count: int) -> None:
        """Raise AnswerUnknown when a stop came since there were so many."""
        if self._count != count:
            raise AnswerUnknown("A stop came first: what was asked before it is not carried out.")

    def stop(self) -> None:
        """Begin to slow down with the ramp; a Tic that heads somewhere nevertheless is halted.

        Raises Refused when it heads somewhere even then.
        """
        self._count += 1
        for command in (*[SLOW_DOWN] * (1 + MOST_REPEATS), HALT, HALT):
            self._conversation.send(command)
            if self._heads_nowhere():
                return
        raise Refused(f"The Tic at {self._port_name} doesn't stop when it is told to: cut the power of its motor.")

    def halt(self) -> None:
        """Make no further step; Refused when the Tic doesn't understand."""
        self._count += 1
        for _ in range(1 + MOST_REPEATS):
            self._conversation.send(HALT)
            if self._memory.input() == Input(InputState.HALT, 0):
                return
        raise Refused(f"The Tic at {self._port_name} doesn't halt when it is told to: cut the power of its motor.")

    def _heads_nowhere(self) -> bool:
        """Whether the Tic has no target: neither one that it was told, nor that of its settings for errors."""
        if self._memory.input() not in NEUTRAL:
            return False
        general = self._memory.general()
        if general.is_homing:
            return False
        return Flag.ENERGIZED not in general.flags or general.planning is not PlanningMode.TARGET_POSITION
