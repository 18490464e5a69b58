"""What a Tic says of itself when it is asked: its variables and settings, read until they make sense."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from typing import TypeVar

from stepramp.controllers.tic.conversation import MOST_REPEATS, Conversation
from stepramp.controllers.tic.ramp import TicRamp
from stepramp.controllers.tic.settings import END, FIRST, LATER, PRODUCT, STEP_MODES, Settings, blocks
from stepramp.controllers.tic.variables import (
    COMMAND_TIMEOUT,
    CONTROL_MODE,
    DRIVER,
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

    def settings(self, between: Callable[[], None] = lambda: None) -> Settings:
        """Return all settings; those are missing that an old Tic doesn't tell. Refused on a disturbed line.

        between: called after each block, since they take about a second together.
        """
        told = self._agreed(FIRST, LATER, between)
        for start, end in ((LATER, PRODUCT), (PRODUCT, END)):
            # What is silent about settings that it doesn't know, answers other questions.
            with suppress(DeviceLost):
                told |= self._agreed(start, end, between)
        self.general()
        return Settings(told)

    def in_use(self) -> dict[str, str]:
        """Return what a Tic has in use, which may be another than its settings, by their names, and where it rests."""
        (starting, fastest), (loss, gain) = (self._twice(block) for block in RAMP)
        step_mode, current_limit, decay_mode = self._twice(DRIVER)
        used = {
            "starting_speed": str(starting),
            "max_speed": str(fastest),
            "max_accel": str(gain),
            "max_decel": str(loss),
            "step_mode": dict(enumerate(STEP_MODES)).get(step_mode, f"code {step_mode}"),
            "current_limit": f"code {current_limit}",
            "decay_mode": f"code {decay_mode}",
        }
        at_rest = not self.look().is_under_way
        return used | ({"position": str(self._twice(MOTION)[0])} if at_rest else {})

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

    def _agreed(self, start: int, end: int, between: Callable[[], None]) -> dict[int, int]:
        """Return the bytes of the settings between two addresses."""
        told: dict[int, int] = {}
        for block in blocks(start, end):
            told.update(enumerate(self._twice(block), block.offset))
            between()
        return told

    def _twice(self, block: Block) -> tuple[int, ...]:
        """Return a block that was read twice in a row: without a CRC a bit that was flipped is another number."""
        last: tuple[int, ...] | None = None
        for _ in range(1 + MOST_REPEATS):
            before, last = last, self._conversation.read(block)
            if last == before:
                return last
        raise Refused("The Tic tells something else each time: is its serial line disturbed?")

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
