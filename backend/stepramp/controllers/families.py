"""The families of controllers: how one of each is reached at a port. A new one is a folder here, and a line below."""

from collections.abc import Callable
from dataclasses import dataclass

from stepramp.controllers.contract import Controller
from stepramp.controllers.progress import Tell
from stepramp.controllers.stepramp.controller import StepRampController
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.link import protocol_sim
from stepramp.link.protocol_sim import VIRTUAL_PORT
from stepramp.link.serial_port import SerialPort

Make = Callable[[SerialPort, Callable[[float], None], Tell], Controller]


@dataclass(frozen=True)
class Family:
    """How a controller of a family is reached."""

    baud_rate: int
    make: Make
    """At an open port; with what to call between two frames of a long exchange, told how long there is time for other
    calls [s], and whom to tell how far a push has come."""


FAMILIES = {"stepramp": Family(115_200, StepRampController)}


def offer_virtual_controller() -> None:
    """Have the virtual controller answer at its port, unless something does already."""
    if not protocol_sim.registered(VIRTUAL_PORT):
        protocol_sim.register(VIRTUAL_PORT, VirtualController())
