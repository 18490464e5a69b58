"""How an axis of the virtual controller is homed: step by step of docs/serial_protocol.md."""

from dataclasses import dataclass
from enum import Enum, auto

from stepramp.controllers.virtual.world import VirtualInputs
from stepramp.ramp.playback.motor import Motor


class Stage(Enum):
    """How far it has come."""

    FAST = auto()
    BACK = auto()
    OFF = auto()
    SLOW = auto()
    FOUND = auto()
    GIVEN_UP = auto()


@dataclass
class VirtualHoming:
    """An axis on its way to its switch. Intervals [ticks]; direction: towards the switch."""

    axis: int
    direction: int
    slow_interval: int
    back_off_steps: int
    stage: Stage = Stage.FAST
    _turns_at: int = 0

    @property
    def steps_to_turn(self) -> int | None:
        """How many steps it goes on until it comes back; None: it isn't at that."""
        return None if self.stage is not Stage.OFF else self.back_off_steps

    def look(self, motor: Motor, inputs: VirtualInputs, now: int) -> None:
        """Go on to the next stage if it is time for that, at an instant [ticks]."""
        active = inputs.in_the_way(self.axis, self.direction) is not None
        if self.stage is Stage.SLOW and active:
            self.stage = Stage.FOUND
        elif self.stage is Stage.FAST and not motor.moving and active:
            self._go(Stage.BACK, -self.direction, motor, now)
        elif not motor.moving:
            self.stage = Stage.GIVEN_UP
        elif self.stage is Stage.BACK and not active:
            self.stage, self._turns_at = Stage.OFF, motor.position - self.direction * self.back_off_steps
        if self.stage is Stage.OFF and (motor.position - self._turns_at) * self.direction <= 0:
            self._go(Stage.SLOW, self.direction, motor, now)

    def _go(self, stage: Stage, direction: int, motor: Motor, now: int) -> None:
        self.stage = stage
        motor.run(self.slow_interval, direction, now)
