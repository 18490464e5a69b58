"""The ramp that a Tic uses, and another one in its place."""

from stepramp.controllers.progress import Progress, PushStage, Tell
from stepramp.controllers.tic.conversation import MOST_REPEATS, Conversation
from stepramp.controllers.tic.memory import Memory
from stepramp.controllers.tic.ramp import TicRamp
from stepramp.controllers.tic.stopping import Stopping
from stepramp.controllers.tic.variables import NEUTRAL
from stepramp.errors import Refused


class RampInUse:
    """The ramp of a Tic as it was last read. tell: called with how far a push has come."""

    def __init__(self, conversation: Conversation, memory: Memory, stopping: Stopping, tell: Tell) -> None:
        self._conversation = conversation
        self._memory = memory
        self._stopping = stopping
        self._tell = tell
        self._ramp = self._stored_ramp = TicRamp(0, 0, 1, 1)

    @property
    def ramp(self) -> TicRamp:
        """The ramp in use."""
        return self._ramp

    @property
    def stored_ramp(self) -> TicRamp:
        """The ramp of the Tic's settings, which is in use after a reset."""
        return self._stored_ramp

    @property
    def is_on_trial(self) -> bool:
        """Whether another ramp is in use than that of the Tic's settings."""
        return self._ramp != self._stored_ramp

    def learn(self) -> None:
        """Ask for the ramp in use and that of the settings."""
        self.look()
        self._stored_ramp = self._memory.stored_ramp()

    def look(self) -> None:
        """Ask for the ramp in use: whoever is at the Tic's USB port may have changed it."""
        self._ramp = self._memory.ramp()

    def use(self, ramp: TicRamp) -> None:
        """Have the Tic use a ramp, and see that it does; Refused when it doesn't.

        Refused, too, and taken back, when a command arrived as one that sets the motor moving.
        """
        harmless = (self._memory.input(), *NEUTRAL)
        for _ in range(1 + MOST_REPEATS):
            self._conversation.send(*ramp.commands)
            if self._memory.input() not in harmless:
                self._stopping.stop()
                raise Refused("A damaged command has set the motor moving, and it was stopped: mend its serial line.")
            self._tell(Progress(PushStage.READING_BACK, 0, 0))
            self.look()
            if self._ramp == ramp:
                return
        raise Refused("The Tic has other figures than those that were sent: is its serial line disturbed?")
