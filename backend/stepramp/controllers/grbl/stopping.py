"""How a grbl is stopped, and that nothing that it was told before goes on afterwards."""

from collections.abc import Callable
from contextlib import suppress

from stepramp.controllers.contract import AnswerUnknown
from stepramp.controllers.grbl.conversation import Conversation
from stepramp.controllers.grbl.dialect import HOLD, JOG_CANCEL, Report, State
from stepramp.errors import DeviceLost, Refused

SURE = 2
"""So often a jog is told to end, each time with an answer after it: what it does not end then is no jog."""


class Stopping:
    """Stops a grbl, and counts how often: what was asked before a stop is not carried out after it.

    may_reset: whether nothing sets out when the controller starts anew.
    """

    def __init__(self, conversation: Conversation, may_reset: Callable[[], bool]) -> None:
        self._conversation = conversation
        self._may_reset = may_reset
        self._count = 0
        self.slows_down = False
        """A jog was told to end, and hasn't been seen at rest since."""
        self._drops = False
        """What it was put on hold with is to be dropped."""
        self.was_halted = False
        """It was reset while it moved: where it is, it doesn't know."""

    @property
    def count(self) -> int:
        """How many stops there were so far."""
        return self._count

    def refuse_stopped(self, count: int) -> None:
        """Raise AnswerUnknown when a stop came since there were so many."""
        if self._count != count:
            raise AnswerUnknown("A stop came first: what was asked before it is not carried out.")

    def stop(self) -> None:
        """Begin to slow down; what isn't a jog is held, and then dropped.

        Raises Refused when it moves on, DeviceLost when it doesn't answer.
        """
        self._count += 1
        self._conversation.send(JOG_CANCEL)
        self._await_answer()
        for _ in range(SURE):
            # A line that was still on its way has begun by now: told again, it ends, too.
            self._conversation.send(JOG_CANCEL)
            report = self._conversation.look()
            if report.state is not State.JOG:
                break
        self.slows_down = report.state is State.JOG
        if report.state in (State.RUN, State.HOME):
            self._hold()
        elif report.state is State.DOOR and report.is_under_way:
            self._end_at_door()
        self._drops = report.state in (State.RUN, State.HOLD)

    def halt(self) -> None:
        """Make no further step; DeviceLost when it doesn't understand."""
        self._count += 1
        if self._conversation.awaits_answer and not self._may_reset():
            # What moves is locked by a reset; at rest it would have something else set out.
            self._conversation.hear_answer()
        if not self._conversation.awaits_answer and not self._conversation.look().is_under_way:
            return
        self.slows_down = self._drops = False
        self._reset()

    def give_up(self) -> None:
        """Have it stop at once, whether it hears or not: what it was told isn't answered."""
        with suppress(DeviceLost):
            self._conversation.send(JOG_CANCEL)
            if self._may_reset():
                self._conversation.reset()

    def note(self, report: Report) -> None:
        """Note whether it has come to rest; what was told to end is told again, and what is held at rest is dropped."""
        if report.state is State.JOG and self.slows_down:
            self._conversation.send(JOG_CANCEL)
        elif not report.is_under_way:
            self.slows_down = False
            if report.state is State.HOLD and self._drops and self._may_reset():
                self._conversation.reset()
            self._drops = False

    def _await_answer(self) -> None:
        """Wait until a line that was sent is answered; without an answer, start anew, which drops it."""
        if not self._conversation.hear_answer() and self._may_reset():
            self._reset()

    def _hold(self) -> None:
        """Have what is no jog slow down; what doesn't, as homing, make no further step."""
        for _ in range(SURE):
            self._conversation.send(HOLD)
            if self._conversation.look().state not in (State.RUN, State.HOME):
                return
        self._reset()

    def _end_at_door(self) -> None:
        """Have what goes on once its door was closed end: it is not put on hold meanwhile, only reset."""
        if not self._may_reset():
            raise Refused(
                "It goes on with its program, as its door was closed, and takes no stop meanwhile: open the door, or "
                "cut the power of its motors."
            )
        self._reset()

    def _reset(self) -> None:
        self._conversation.reset()
        report = self._conversation.look()
        self.was_halted = report.state is State.ALARM
        if report.state is State.RUN:
            # It had just come to rest, and carries its start-up lines out.
            self._conversation.send(HOLD)
