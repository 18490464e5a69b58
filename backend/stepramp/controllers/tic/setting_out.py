"""How a motion of a Tic begins: told and read back first, and only then allowed; and what keeps it from beginning.

What a Tic was told last it keeps through errors, and obeys again once they are over: so never the other way round.
"""

from collections.abc import Callable
from typing import NoReturn

from stepramp.controllers.tic.conditions import BY_ITSELF, told
from stepramp.controllers.tic.conversation import MOST_REPEATS, Conversation
from stepramp.controllers.tic.course import Course
from stepramp.controllers.tic.memory import Memory
from stepramp.controllers.tic.stopping import Stopping
from stepramp.controllers.tic.variables import (
    Condition,
    Input,
    InputState,
    OperationState,
    PlanningMode,
    Variables,
)
from stepramp.controllers.tic.wire import Quick, Write, quick, write
from stepramp.errors import Refused

STARTING_POLLS = 10
STARTING_POLL_S = 0.02
"""A Tic needs at most 10 ms until its motor's current is steady; safe start is left for 200 ms."""
LEAST_TIMEOUT_MS = 1000
"""A command timeout that a device keeps up, since it asks for a status each half second; what a Tic comes with."""


class SettingOut:
    """Has a Tic set out, unless a stop has come since that was asked for."""

    def __init__(
        self,
        conversation: Conversation,
        memory: Memory,
        stopping: Stopping,
        course: Course,
        give_way: Callable[[float], None],
    ) -> None:
        self._conversation = conversation
        self._memory = memory
        self._stopping = stopping
        self._course = course
        self._give_way = give_way
        self._timeout_ms = 0

    def learn_timeout(self) -> None:
        """Ask how long the Tic waits for commands."""
        self._timeout_ms = self._memory.command_timeout_ms()

    def inability(self, conditions: Condition) -> str | None:
        """Return what keeps the Tic from moving until something is mended, as a sentence; None for nothing."""
        if conditions & BY_ITSELF:
            return _cannot_move(conditions & BY_ITSELF)
        if 0 < self._timeout_ms < LEAST_TIMEOUT_MS:
            return (
                f"The Tic can't move: its command timeout is {self._timeout_ms} ms, so it would stop before StepRamp "
                f"speaks to it again; set it to at least {LEAST_TIMEOUT_MS:,} ms in the Tic Control Center."
            )
        return None

    def refuse_unable(self, seen: Variables) -> None:
        """Refuse a motion before anything is said of it, when something is in its way that no command ends."""
        if (reason := self.inability(seen.general.conditions)) is not None:
            raise Refused(reason)

    def resting_position(self) -> tuple[int, Variables]:
        """Return where the motor rests, or will: seen twice in a row, since moves count from there; and all seen.

        Raises Refused while it runs at a speed, or slows down.
        """
        last = None
        for _ in range(1 + MOST_REPEATS):
            seen = self._memory.look()
            if seen.is_under_way and seen.general.planning is not PlanningMode.TARGET_POSITION:
                raise Refused("The motor runs, so it isn't known yet where it comes to rest: say a position, or wait.")
            position = seen.general.target_position if seen.is_under_way else seen.position
            if position == last:
                return position, seen
            last = position
        raise Refused("The Tic tells another position each time: is its serial line disturbed?")

    def to_position(self, target: int, seen: Variables, stops: int) -> None:
        """Begin to move to a position [steps].

        seen: just before. stops: how many had come when it was asked for. Raises AnswerUnknown when one came since,
        Refused when something keeps the Tic from moving.
        """
        told_so = Input(InputState.TARGET_POSITION, target)
        self._begin(write(Write.TARGET_POSITION, target), told_so, seen, stops)

    def at_velocity(self, units: int, seen: Variables, stops: int) -> None:
        """Begin to run at a speed [Tic's units], with its sign; see to_position."""
        told_so = Input(InputState.TARGET_VELOCITY, units)
        self._begin(write(Write.TARGET_VELOCITY, units), told_so, seen, stops)

    def _begin(self, command: bytes, told_so: Input, seen: Variables, stops: int) -> None:
        """Tell the Tic a target, see that it has it, and let it move."""
        self.refuse_unable(seen)
        self._tell_target(command, told_so, stops)
        self._course.set_out_from(seen)
        self._let_move(told_so, stops)
        self._course.begin()

    def _tell_target(self, command: bytes, told_so: Input, stops: int) -> None:
        for _ in range(1 + MOST_REPEATS):
            self._stopping.refuse_stopped(stops)
            self._conversation.send(command)
            if self._memory.input() == told_so:
                return
        self._give_up("The Tic doesn't take its target: is its serial line disturbed?", stops)

    def _let_move(self, told_so: Input, stops: int) -> None:
        """End what keeps the Tic from moving until it is told to; it has its target by now."""
        for _ in range(STARTING_POLLS):
            # What occurred before it moved has ended nothing of that.
            general = self._memory.forget_errors()
            self._stopping.refuse_stopped(stops)
            if general.operation is OperationState.NORMAL and self._memory.acted_on(general) == told_so:
                return
            if general.conditions:
                energize = [quick(Quick.ENERGIZE)] if Condition.DEENERGIZED in general.conditions else []
                self._conversation.send(*energize, quick(Quick.EXIT_SAFE_START))
            self._give_way(STARTING_POLL_S)
        self._give_up(_cannot_move(general.conditions, homing=general.is_homing), stops)

    def _give_up(self, reason: str, stops: int) -> NoReturn:
        """Refuse a motion, and have the Tic forget what it was told of it."""
        self._stopping.refuse_stopped(stops)
        self._stopping.stop()
        raise Refused(reason)


def _cannot_move(conditions: Condition, *, homing: bool = False) -> str:
    other = "it goes on homing" if homing else "it does not start up"
    return f"The Tic can't move: {told(conditions) or other}."
