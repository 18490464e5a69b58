"""The course of what was asked for over this connection: how long it lasts, and what has ended it."""

from stepramp.controllers.tic.conditions import LETTING_GO, told_afterwards
from stepramp.controllers.tic.conversation import Conversation
from stepramp.controllers.tic.memory import Memory
from stepramp.controllers.tic.stopping import Stopping
from stepramp.controllers.tic.variables import (
    NEUTRAL,
    Condition,
    General,
    Input,
    InputState,
    OperationState,
    Variables,
)
from stepramp.controllers.tic.wire import Quick, quick

AT_A_SWITCH = "The Tic has stopped at a limit switch: it does not go on when the switch is released."


class Course:
    """Keeps a motion from timing out; but once something else has ended it, sees to it that it doesn't go on."""

    def __init__(self, conversation: Conversation, memory: Memory, stopping: Stopping) -> None:
        self._conversation = conversation
        self._memory = memory
        self._stopping = stopping
        self._leads = False
        """The Tic moves, or holds its motor, for what was asked over this connection: so it is kept from timing out."""
        self._is_going = False
        """What was asked for last had not come to its end yet, when the Tic was last looked at."""
        self._holds = False
        """The motor had its current, when the Tic was last looked at."""
        self._past_trouble: str | None = None
        self._set_out_at = 0

    @property
    def past_trouble(self) -> str | None:
        """What ended the last motion, or let go of the motor, since it was last moved or its position set."""
        return self._past_trouble

    def steps_made(self, position: int) -> int:
        """Return how many steps a position is from where the motor last set out from rest."""
        return abs(position - self._set_out_at)

    def learn(self, seen: Variables) -> None:
        """Take what a Tic does when the connection begins as given."""
        self._set_out_at, self._holds = seen.position, seen.general.holds

    def count_from(self, position: int) -> None:
        """Note that the place where the motor rests was given a position."""
        self._set_out_at, self._past_trouble = position, None

    def set_out_from(self, seen: Variables) -> None:
        """Note where the motor rested before it was told a target; one that moves goes on from where it set out."""
        if not seen.velocity:
            self._set_out_at = seen.position

    def begin(self) -> None:
        """Note that the Tic does from now on what was asked."""
        self._leads = self._is_going = self._holds = True
        self._past_trouble = None

    def prolong(self, general: General) -> None:
        """Keep the Tic from timing out as long as it does what was asked.

        general: just read. What is older might say nothing of a timeout that is there by now, and be ended by that.
        """
        if self._leads and _is_undisturbed(general):
            self._conversation.send(quick(Quick.RESET_COMMAND_TIMEOUT))

    def note(self, seen: Variables) -> None:
        """Note what has ended the motion, or let go of the motor, and let the Tic not go on with it by itself."""
        # Errors that occurred before the motion began are forgotten.
        occurred = seen.general.occurred if self._leads else Condition(0)
        stopped = self._leads and not self._lasts(seen)
        let_go = self._holds and (not seen.general.holds or bool(occurred & LETTING_GO))
        self._holds = seen.general.holds
        if stopped and seen.is_held_by_a_switch:
            self._past_trouble = AT_A_SWITCH
        elif stopped or let_go:
            conditions = seen.general.conditions | occurred
            self._past_trouble = told_afterwards(conditions, stopped=stopped, let_go=let_go)

    def _lasts(self, seen: Variables) -> bool:
        """Return whether the Tic still does what was asked, or had done that before; once it doesn't, stop it."""
        # At a limit switch it rests with its target ahead, and would go on once the switch is released.
        if _is_undisturbed(seen.general) and not seen.is_held_by_a_switch:
            self._is_going = seen.is_under_way
            return True
        done = not self._is_going or self._memory.input() in (
            *NEUTRAL,
            Input(InputState.TARGET_POSITION, seen.position),
        )
        self._leads = self._is_going = False
        self._stopping.stop()
        return done


def _is_undisturbed(general: General) -> bool:
    """Whether a Tic does what it was told, and has done so since it set out for that."""
    return general.operation is OperationState.NORMAL and not general.occurred
