"""The families of controllers: how one of each is reached at a port. A new one is a folder here, and a line below."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import cast

from stepramp.controllers.capabilities import CapabilityName, capabilities_of_class
from stepramp.controllers.contract import Controller
from stepramp.controllers.fluidnc import ramp as fluidnc
from stepramp.controllers.fluidnc.controller import FluidNcController
from stepramp.controllers.fluidnc.own_ramp import own_ramp as fluidnc_own_ramp
from stepramp.controllers.fluidnc.read_settings import read_settings as fluidnc_read_settings
from stepramp.controllers.grbl import dialect as grbl_dialect
from stepramp.controllers.grbl import ramp as grbl
from stepramp.controllers.grbl.controller import GrblController
from stepramp.controllers.grbl.own_ramp import own_ramp
from stepramp.controllers.grbl.read_settings import read_settings
from stepramp.controllers.klipper import ramp as klipper
from stepramp.controllers.klipper.controller import KlipperController
from stepramp.controllers.klipper.own_ramp import own_ramp as klipper_own_ramp
from stepramp.controllers.klipper.read_settings import read_settings as klipper_read_settings
from stepramp.controllers.marlin import dialect as marlin_dialect
from stepramp.controllers.marlin import ramp as marlin
from stepramp.controllers.marlin.controller import MarlinController
from stepramp.controllers.marlin.own_ramp import own_ramp as marlin_own_ramp
from stepramp.controllers.marlin.read_settings import read_settings as marlin_read_settings
from stepramp.controllers.own_ramp import PlayOwn
from stepramp.controllers.progress import Tell
from stepramp.controllers.read_axis import ReadSettings
from stepramp.controllers.stepramp.controller import StepRampController
from stepramp.controllers.stepramp.settings import StepRampSettings
from stepramp.controllers.tic import ramp as tic
from stepramp.controllers.tic.controller import TicController
from stepramp.controllers.tic.own_ramp import own_ramp as tic_own_ramp
from stepramp.controllers.tic.read_settings import read_settings as tic_read_settings
from stepramp.controllers.tmcl import ramp as tmcl
from stepramp.controllers.tmcl.controller import TmclController
from stepramp.controllers.tmcl.own_ramp import own_ramp as tmcl_own_ramp
from stepramp.controllers.tmcl.read_settings import read_settings as tmcl_read_settings
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.link import protocol_sim
from stepramp.link.connection import Connection
from stepramp.link.moonraker_port import SCHEME as MOONRAKER
from stepramp.link.moonraker_port import MoonrakerPort
from stepramp.link.protocol_sim import VIRTUAL_PORT
from stepramp.link.remote_ports import RemotePorts
from stepramp.link.serial_port import SerialPort
from stepramp.validation import Document

Open = Callable[[str, Callable[[], None], RemotePorts], Connection]
"""Opens a port; with what to call at the last instant before bytes go out, which may raise to keep them from going, and
which ports of other machines may be opened.

Raises Rejected for an address that is no port or none that may be opened, DeviceLost when it can't be opened."""
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
    is_behind_moonraker: bool = False
    """It is reached through Klipper's server, and at no serial port."""
    cannot: tuple[str, ...] = ()
    """What its controllers can't take of a design, or do, as sentences."""
    play_own: PlayOwn | None = None
    """What they play of a design's move; None: the intervals of the design, or it isn't known."""
    read_settings: ReadSettings | None = None
    """Makes designs of what they tell of themselves, as text; None where nothing is told that is a ramp."""
    reads: str = ""
    """What that text is, as people know it, if there is such."""
    same_as: str | None = None
    """Name of the family whose controllers these are, too, reached in another way; None: it is one of its own."""
    controller: type | None = None
    """The class of what make makes; None: make is that."""
    names_itself: Callable[[str], bool] | None = None
    """Tells whether a line that a controller says as it starts names this family; None: they say nothing unasked."""

    @property
    def kind(self) -> str:
        """What its backups can be written to: controllers of a family of the same kind."""
        return self.same_as or self.name

    @property
    def capabilities(self) -> tuple[CapabilityName, ...]:
        """What its controllers can do at most, besides what all can."""
        return capabilities_of_class(self.controller or cast(type, self.make))

    @property
    def plays_own(self) -> bool:
        """Whether it is known how its controllers work the intervals out themselves."""
        return self.play_own is not None

    @property
    def reads_settings(self) -> bool:
        """Whether what its controllers tell of themselves can be made designs of."""
        return self.read_settings is not None

    def may_be_at(self, port: str) -> bool:
        """Whether a controller of it may be at a port."""
        if port.startswith(f"{MOONRAKER}://") or self.is_behind_moonraker:
            return port.startswith(f"{MOONRAKER}://") and self.is_behind_moonraker
        return self.has_virtual or port != VIRTUAL_PORT


def _klipper(port: Connection, give_way: Callable[[float], None], tell: Tell) -> Controller:
    # What opens a port of this family gives such a one.
    return KlipperController(cast(MoonrakerPort, port), give_way, tell)


@dataclass(frozen=True)
class AtBaudRate:
    """Opens serial ports at a baud rate; an Open, of which two with the same rate are the same."""

    baud_rate: int

    def __call__(self, port: str, before_write: Callable[[], None], remote_ports: RemotePorts) -> Connection:
        """Open a port; see Open."""
        return SerialPort(port, before_write, remote_ports, self.baud_rate)


USUAL_FAMILY = "stepramp"
"""That of a controller of which nothing else is said."""
FAMILIES = {
    each.name: each
    for each in (
        Family("stepramp", "StepRamp", AtBaudRate(115_200), StepRampController, StepRampSettings, has_virtual=True),
        Family(
            "tic",
            "Pololu Tic",
            AtBaudRate(9_600),
            TicController,
            cannot=tic.CANNOT,
            play_own=tic_own_ramp,
            read_settings=tic_read_settings,
            reads="settings file (max_speed: 2000000)",
        ),
        Family(
            "grbl",
            "grbl",
            AtBaudRate(115_200),
            GrblController,
            cannot=grbl.CANNOT,
            play_own=own_ramp,
            read_settings=read_settings,
            reads="lines after $$ ($100=250.000)",
            names_itself=grbl_dialect.is_banner_of_grbl,
        ),
        Family(
            "fluidnc",
            "FluidNC",
            AtBaudRate(115_200),
            FluidNcController,
            cannot=fluidnc.CANNOT,
            play_own=fluidnc_own_ramp,
            read_settings=fluidnc_read_settings,
            reads="configuration (axes: with x: below it)",
            names_itself=grbl_dialect.is_banner_of_fluidnc,
        ),
        Family(
            "tmcl",
            "Trinamic TMCL",
            AtBaudRate(9_600),
            TmclController,
            cannot=tmcl.CANNOT,
            play_own=tmcl_own_ramp,
            read_settings=tmcl_read_settings,
            reads="backup, saved here",
        ),
        Family(
            "klipper",
            "Klipper",
            MoonrakerPort,
            _klipper,
            cannot=klipper.CANNOT,
            play_own=klipper_own_ramp,
            read_settings=klipper_read_settings,
            reads="printer.cfg ([stepper_x])",
            is_behind_moonraker=True,
            controller=KlipperController,
        ),
        *(
            Family(
                name,
                title,
                AtBaudRate(baud_rate),
                MarlinController,
                cannot=marlin.CANNOT,
                play_own=marlin_own_ramp,
                read_settings=marlin_read_settings,
                reads="lines after M503 (M92 X80.00)",
                same_as=None if name == "marlin" else "marlin",
                names_itself=marlin_dialect.is_banner,
            )
            # Boards with an ATmega mostly talk at the rate that divides their clock.
            for name, title, baud_rate in (
                ("marlin", "Marlin", 115_200),
                ("marlin_250000", "Marlin at 250,000 baud", 250_000),
            )
        ),
    )
}


def offer_virtual_controller() -> None:
    """Have the virtual controller answer at its port, unless something does already."""
    if not protocol_sim.registered(VIRTUAL_PORT):
        protocol_sim.register(VIRTUAL_PORT, VirtualController())
