"""What a Tic says of itself when it is asked: its variables and settings, read until they make sense."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from typing import TypeVar

from stepramp.controllers.tic.conversation import MOST_REPEATS, Conversation
from stepramp.controllers.tic.ramp import TicRamp
from stepramp.controllers.tic.stored_settings import BLOCKS
from stepramp.controllers.tic.variables import (
    COMMAND_TIMEOUT,
    CONTROL_MODE,
    GENERAL,
    INPUT,
    LAST_OF_ERRORS,
    MICROSTEPS,
    MOTION,
    RAMP,
    STEP_MODE,
    STORED_RAMP,
    TARGET_VELOCITY,
    UP_TIME,
    Block,
    General,
    Input,
    InputState,
    PlanningMode,
    Variables,
)
from stepramp.errors import DeviceLost, Refused

T = TypeVar("T")


class Memory:
    """The memory of a Tic, asked for block by block. All calls raise DeviceLost when it gives no answers with sense."""

    def __init__(self, conversation: Conversation, port_name: str) -> None:
        self._conversation = conversation
        self._port_name = port_name
        self._up_time_ms: int | None = None

    def control_mode(self) -> int:
        """Return where the Tic takes its targets from."""
        return self._conversation.read(CONTROL_MODE)[0]

    def command_timeout_ms(self) -> int:
        """Return how long the Tic waits for a command until it stops; 0: for ever [ms]."""
        return self._conversation.read(COMMAND_TIMEOUT)[0]

    def microsteps(self) -> int:
        """Return how many steps the Tic makes of a full step, by the step mode in use."""
        return self._sensible(lambda: _known(MICROSTEPS, self._conversation.read(STEP_MODE)[0]))

    def ramp(self) -> TicRamp:
        """Return the ramp in use."""
        return self._ramp_of(RAMP)

    def stored_ramp(self) -> TicRamp:
        """Return the ramp that is in use after a reset."""
        return self._ramp_of(STORED_RAMP)

    def stored(self) -> bytes:
        """Return all that the Tic keeps without power; Refused when it isn't told the same twice."""
        told = b""
        for _ in range(2 + MOST_REPEATS):
            before, told = told, bytes(value for block in BLOCKS for value in self._conversation.read(block))
            if told == before:
                return told
        raise Refused("The Tic tells other settings each time: is its serial line disturbed?")

    def input(self) -> Input:
        """Return what the Tic was last told."""
        return self._sensible(lambda: Input.of(*self._conversation.read(INPUT)))

    def general(self) -> General:
        """Return how the Tic fares as a whole."""
        return self._sensible(lambda: General.of(*self._conversation.read(GENERAL)))

    def forget_errors(self) -> General:
        """Have the Tic forget which errors have occurred, and return how it fares as a whole."""
        return self._sensible(lambda: General.of(*self._conversation.read(LAST_OF_ERRORS)))

    def look(self) -> Variables:
        """Return how the Tic fares; DeviceLost when it was restarted since the last time."""
        return self.variables(self.general())

    def variables(self, general: General) -> Variables:
        """Return how the Tic fares, of which the first part was just read; see look."""
        self._refuse_restarted()
        (target_velocity,) = self._conversation.read(TARGET_VELOCITY)
        # Last, so that what is told to have ended is told where.
        position, velocity = self._conversation.read(MOTION)
        return Variables(general, target_velocity, position, velocity)

    def acted_on(self, general: General) -> Input | None:
        """Return what the Tic makes steps for, as it is told such things; None for nothing, and for homing."""
        if general.is_homing:
            return None
        if general.planning is PlanningMode.TARGET_POSITION:
            return Input(InputState.TARGET_POSITION, general.target_position)
        if general.planning is PlanningMode.TARGET_VELOCITY:
            return Input(InputState.TARGET_VELOCITY, self._conversation.read(TARGET_VELOCITY)[0])
        return None

    def _ramp_of(self, blocks: Sequence[Block]) -> TicRamp:
        return self._sensible(
            lambda: TicRamp.told(*(value for block in blocks for value in self._conversation.read(block)))
        )

    def _refuse_restarted(self) -> None:
        # Noted at once: something more urgent may look, too, before the next question.
        (up_time_ms,) = self._conversation.read(UP_TIME)
        before_ms, self._up_time_ms = self._up_time_ms, up_time_ms
        if before_ms is not None and (up_time_ms - before_ms) % 2**32 >= 2**31:
            raise DeviceLost(f"The Tic at {self._port_name} was restarted: its position is no longer known.")

    def _sensible(self, read: Callable[[], T]) -> T:
        """Return what was read, read again when no Tic says so: noise that has the right length."""
        for _ in range(1 + MOST_REPEATS):
            with suppress(ValueError):
                return read()
        raise DeviceLost(f"The Tic at {self._port_name} gives answers without sense.")


def _known(known: Mapping[int, int], value: int) -> int:
    """Return what a value means; ValueError when no Tic says so."""
    if value not in known:
        raise ValueError("a value that is reserved")
    return known[value]
