"""A controller whose inputs are connected: a client of version 3, and what it is connected to."""

from typing import Self

from firmware import protocol as p
from firmware.controller.client import Controller
from firmware.controller.ramps import FOUR_AXES, OTHER, RAMP
from firmware.controller_host import Driver
from firmware.protocol import InputSettings, InputsStatus, Settings, Status

STOP_INPUT, FAULT_INPUT, LOW_INPUT, HIGH_INPUT = 0, 1, 6, 7
ROLES = {
    STOP_INPUT: p.EMERGENCY_STOP,
    FAULT_INPUT: p.DRIVER_FAULT,
    LOW_INPUT: p.LOW_LIMIT,
    HIGH_INPUT: p.HIGH_LIMIT | p.AT_ONCE,
}
"""Of axis 0; all are active when they are low."""
ALL_HIGH = 0x1FF
OUTPUT_STATUS_BYTES = 26
__all__ = ["ALL_HIGH", "FOUR_AXES", "OTHER", "RAMP", "ROLES", "Machine"]


class Machine(Controller):
    """A controller, and the pins of its inputs, which are high unless something pulls them down."""

    low: set[int]

    @classmethod
    def started(cls, driver: Driver) -> Self:
        """Switch the controller on, begin a session of version 3, and give it roles and a ramp of one axis."""
        driver.ask("begin")
        machine = cls(driver)
        machine.low = set()
        machine.ok(p.HELLO, b"\3")
        machine.push(RAMP)
        machine.give()
        return machine

    def give(self, inputs: InputSettings | None = None, outputs: Settings | None = None) -> None:
        """Give it settings."""
        self.ok(p.WRITE_SETTINGS, (outputs or Settings()).packed() + (inputs or InputSettings(roles=ROLES)).packed())

    def pull_down(self, *inputs: int) -> None:
        """Have these pins be low, and no others."""
        self.low = set(inputs)
        self.driver.ask("levels", ALL_HIGH & ~sum(1 << each for each in inputs))

    def pass_ms(self, milliseconds: int) -> None:
        self.driver.ask("pass", milliseconds)

    def go_on_ms(self, milliseconds: int) -> None:
        """Let time pass with a client that goes on asking."""
        for _ in range(0, milliseconds, 200):
            self.pass_ms(min(milliseconds, 200))
            self.status()

    def status(self, axis: int = 0) -> Status:
        return Status.unpack(self.ok(p.STATUS, bytes([axis]))[:OUTPUT_STATUS_BYTES])

    def inputs(self) -> InputsStatus:
        return InputsStatus.unpack(self.ok(p.STATUS, b"\0")[OUTPUT_STATUS_BYTES:])

    def add_switch(self, number: int, axis: int, at: int, *, is_backward: bool) -> None:
        """Connect a switch that is closed where the axis is there or beyond."""
        self.driver.ask("switch", number, axis, int(is_backward), at)

    def go_to_rest(self) -> Status:
        """Return the status once all is at rest, as it is with a client that goes on asking."""
        for _ in range(1000):
            self.pass_ms(50)
            if self.inputs().homing == 0 and self.status().state == p.IDLE:
                return self.status()
        raise AssertionError("It moves on and on.")
