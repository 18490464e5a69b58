"""What one axis of a module tells of itself, and is told."""

from collections.abc import Callable
from dataclasses import dataclass

from stepramp.controllers.tmcl.conversation import Conversation
from stepramp.controllers.tmcl.modules import Module
from stepramp.controllers.tmcl.units import UnitMode, Units
from stepramp.controllers.tmcl.wire import Command
from stepramp.errors import Refused

MOST_ROUNDINGS = 2
MOST_RESOLUTION = 8
"""256 microsteps."""


@dataclass(frozen=True)
class Seen:
    """Where an axis was seen [steps], and how fast, in the module's units with sign."""

    position: int
    speed: int


class Axis:
    """The parameters of one axis, asked for one by one. All calls raise DeviceLost when the module doesn't answer."""

    def __init__(self, conversation: Conversation, module: Module, number: int) -> None:
        self.number = number
        self.parameters = module.parameters
        self._clock_hz = module.clock_hz
        self._conversation = conversation

    def get(self, parameter: int) -> int:
        """Return a parameter; Denied when the axis has none of that number."""
        return self._conversation.ask(Command.GAP, parameter, self.number)

    def set(self, parameter: int, value: int) -> None:
        """Set a parameter; Denied when the axis doesn't take it."""
        self._conversation.ask(Command.SAP, parameter, self.number, value)

    def call(self, parameter: int, value: int) -> bool:
        """Set a parameter, and return whether it has the value."""
        self.set(parameter, value)
        return self.get(parameter) == value

    def bring_back(self, parameter: int, told: int) -> bool:
        """Set a parameter to what the module has told of it before, and return whether it tells that again.

        What it rounds when it takes it and when it tells it is made up for: it is sent so much more.
        """
        value = told
        for _ in range(1 + MOST_ROUNDINGS):
            self.set(parameter, value)
            off = told - self.get(parameter)
            if not off:
                return True
            value += off
            if not -(2**31) <= value < 2**31:
                break
        return False

    def store(self, parameter: int, allowed: Callable[[], None]) -> None:
        """Store a parameter as it is; Denied when the memory is locked. allowed: see Conversation.ask."""
        self._conversation.ask(Command.STAP, parameter, self.number, allowed=allowed)

    def recall(self, parameter: int, allowed: Callable[[], None]) -> None:
        """Set a parameter to what is stored. allowed: see Conversation.ask."""
        self._conversation.ask(Command.RSAP, parameter, self.number, allowed=allowed)

    def units(self) -> Units:
        """Ask for the axis' units; Refused when they aren't known."""
        mode = self.get(self.parameters.unit_mode)
        if mode not in set(UnitMode):
            raise Refused(f"Axis {self.number} has unit mode {mode} (axis parameter 255), which StepRamp doesn't know.")
        return Units(UnitMode(mode), self._clock_hz)

    def microsteps(self) -> int:
        """Ask how many steps the axis makes of a full step; Refused when no module makes so many."""
        resolution = self.get(self.parameters.resolution)
        if not 0 <= resolution <= MOST_RESOLUTION:
            raise Refused(
                f"Axis {self.number} has microstep resolution {resolution} (axis parameter "
                f"{self.parameters.resolution}), of which there are 0 to {MOST_RESOLUTION}."
            )
        return 1 << resolution

    def look(self) -> Seen:
        """Return where the axis is; its position is asked for last, so that an end that is told is told where."""
        speed = self.get(self.parameters.speed)
        return Seen(self.get(self.parameters.position), speed)

    def go_to(self, position: int, allowed: Callable[[], None]) -> bool:
        """Tell the axis a target, and return whether it has it; allowed: see Conversation.ask."""
        self._conversation.ask(Command.MVP, 0, self.number, position, allowed=allowed)
        return self.get(self.parameters.target_position) == position

    def go_at(self, speed: int, allowed: Callable[[], None]) -> bool:
        """Tell the axis a speed with its sign, and return whether it has one of that sign."""
        command = Command.ROR if speed > 0 else Command.ROL
        self._conversation.ask(command, 0, self.number, abs(speed), allowed=allowed)
        return self.get(self.parameters.target_speed) * speed > 0

    def slow_down(self) -> bool:
        """Tell the axis to come to rest, and return whether it heads nowhere."""
        self._conversation.ask(Command.MST, 0, self.number)
        return not self.get(self.parameters.target_speed)
