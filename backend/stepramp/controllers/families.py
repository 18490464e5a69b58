"""The families of controllers: how one of each is reached at a port. A new one is a folder here, and a line below."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from stepramp.controllers.contract import Controller
from stepramp.controllers.progress import Tell
from stepramp.controllers.stepramp.controller import StepRampController
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.controllers.tic.controller import TicController
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.link import protocol_sim
from stepramp.link.connection import Connection
from stepramp.link.protocol_sim import VIRTUAL_PORT
from stepramp.link.serial_port import SerialPort
from stepramp.validation import Document

Open = Callable[[str, Callable[[], None]], Connection]
"""Opens a port; with what to call at the last instant before bytes go out, which may raise to keep them from going.

Raises Rejected for an address that is no port, DeviceLost when it can't be opened."""
Make = Callable[[Connection, Callable[[float], None], Tell], Controller]
"""Makes a controller at an open port; with what to call between two frames of a long exchange, told how long there is
time for other calls [s], and whom to tell how far a push has come."""


@dataclass(frozen=True)
class Family:
    """How a controller of a family is reached."""

    name: str
    """What programs call it."""
    title: str
    """What people call it."""
    open: Open
    make: Make
    settings: type[Document] | None = None
    """What its settings are a document of, if it is a HasSettings."""
    has_virtual: bool = False
    """The virtual controller is one of it."""

    def may_be_at(self, port: str) -> bool:
        """Whether a controller of it may be at a port."""
        return self.has_virtual or port != VIRTUAL_PORT


def at_baud_rate(baud_rate: int) -> Open:
    """Return what opens serial ports at a baud rate."""
    return partial(SerialPort, baud_rate=baud_rate)


USUAL_FAMILY = "stepramp"
"""That of a controller of which nothing else is said."""
FAMILIES = {
    each.name: each
    for each in (
        Family("stepramp", "StepRamp", at_baud_rate(115_200), StepRampController, StepRampSettings, has_virtual=True),
        Family("tic", "Pololu Tic", at_baud_rate(9_600), TicController),
    )
}


def offer_virtual_controller() -> None:
    """Have the virtual controller answer at its port, unless something does already."""
    if not protocol_sim.registered(VIRTUAL_PORT):
        protocol_sim.register(VIRTUAL_PORT, VirtualController())
