"""How a module's axes are stopped, and that it has understood."""

from collections.abc import Collection, Sequence
from time import monotonic

from stepramp.controllers.contract import AnswerUnknown
from stepramp.controllers.tmcl.axis import Axis
from stepramp.controllers.tmcl.conversation import MOST_REPEATS, Conversation
from stepramp.controllers.tmcl.program import Program
from stepramp.controllers.tmcl.ramp import halting_acceleration
from stepramp.controllers.tmcl.wire import Command
from stepramp.errors import Refused

FIRST_ANSWER_S = 0.05
"""So long each axis is given for its answer when all are told at first, so that none waits for another's [s]."""
REST_S = 3.0
"""So long a halted axis is looked at until it rests [s]: it slows down for 1.1 s at most."""


class Stopping:
    """Stops axes, and counts how often: what was asked before a stop is not carried out after it."""

    def __init__(self, conversation: Conversation, program: Program, axes: Sequence[Axis]) -> None:
        self._conversation = conversation
        self._program = program
        self._axes = axes
        self._count = 0

    @property
    def count(self) -> int:
        """How many stops there were so far."""
        return self._count

    def refuse_stopped(self, count: int) -> None:
        """Raise AnswerUnknown when a stop came since there were so many."""
        if self._count != count:
            raise AnswerUnknown("A stop came first: what was asked before it is not carried out.")

    def stop(self, axes: Collection[int] | None = None) -> None:
        """Begin to slow down: these axes, or all; and end the program in the module, which could move them again.

        Raises Refused when one heads somewhere even then.
        """
        self._count += 1
        named = self._named(axes)
        self._tell_at_once(named)
        self._slow_down(named)
        self._end_program(named)

    def halt(self, axes: Collection[int] | None = None) -> None:
        """Come to rest as fast as the module can: these axes, or all; Refused as with stop.

        That is with the chip's highest acceleration. The one that was in use is set again at rest.
        """
        self._count += 1
        named = self._named(axes)
        self._tell_at_once(named)
        # Before the accelerations are touched: what is lost then slows down nevertheless.
        self._slow_down(named)
        moving = [axis for axis in named if axis.get(axis.parameters.speed)]
        units = {axis: axis.units() for axis in moving}
        before = {axis: units[axis].acceleration_again(axis.get(axis.parameters.amax)) for axis in moving}
        try:
            for axis in moving:
                axis.set(axis.parameters.amax, halting_acceleration(units[axis]))
            self._slow_down(moving)
            for axis in moving:
                self._await_rest(axis)
        finally:
            for axis, acceleration in before.items():
                axis.set(axis.parameters.amax, acceleration)
        self._end_program(named)

    def _named(self, axes: Collection[int] | None) -> list[Axis]:
        return [axis for axis in self._axes if axes is None or axis.number in axes]

    def _tell_at_once(self, axes: Sequence[Axis]) -> None:
        for axis in axes:
            self._conversation.tell_at_once(Command.MST, axis.number, FIRST_ANSWER_S)

    def _slow_down(self, axes: Sequence[Axis]) -> None:
        for axis in axes:
            left = 1 + MOST_REPEATS
            while not axis.slow_down():
                left -= 1
                if not left:
                    raise self._disobedient(axis, "stop")
                # It may tell the axis something else as soon as that was stopped.
                self._program.end()

    def _end_program(self, axes: Sequence[Axis]) -> None:
        if self._program.end():
            self._slow_down(axes)

    def _await_rest(self, axis: Axis) -> None:
        deadline_s = monotonic() + REST_S
        while axis.get(axis.parameters.speed):
            if monotonic() > deadline_s:
                raise self._disobedient(axis, "come to rest")

    def _disobedient(self, axis: Axis, what: str) -> Refused:
        return Refused(
            f"Axis {axis.number} of the TMCL module at {self._conversation.name} doesn't {what} when it is told to: "
            "cut the power of its motor."
        )
