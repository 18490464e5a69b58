from collections.abc import Callable, Iterator
from secrets import token_hex

import pytest

from stepramp.controllers.stepramp.controller import StepRampController
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.link import protocol_sim
from stepramp.link.protocol_sim import VirtualDevice
from stepramp.link.serial_port import SerialPort


class Clock:
    """A clock that tests set [s]."""

    def __init__(self) -> None:
        self.now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture
def plug_in() -> Callable[[VirtualDevice], str]:
    """Plug a virtual device in at a port of its own, and return that."""

    def plug_in(device: VirtualDevice) -> str:
        # No other test's: this file is loaded more than once, and a device of another may still be looked for.
        port = f"sim://test-{token_hex(8)}"
        protocol_sim.register(port, device)
        return port

    return plug_in


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def virtual(clock: Clock) -> VirtualController:
    return VirtualController(clock)


@pytest.fixture
def controller(virtual: VirtualController, plug_in: Callable[[VirtualDevice], str]) -> Iterator[StepRampController]:
    """Return a client, connected to the virtual controller whose clock stands still."""
    port = SerialPort(plug_in(virtual))
    controller = StepRampController(port)
    controller.connect()
    yield controller
    port.close()
