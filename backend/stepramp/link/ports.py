"""The serial ports that can be opened, with names that people know."""

import os
import re
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePath

from serial.tools import list_ports
from serial.tools.list_ports_common import ListPortInfo

from stepramp.errors import escaped
from stepramp.link.protocol_sim import VIRTUAL_PORT, registered
from stepramp.link.remote_ports import RemotePort

BOARDS = {
    (0x2341, 0x0043): "Arduino Uno",
    (0x2341, 0x0001): "Arduino Uno",
    (0x2A03, 0x0043): "Arduino Uno",
    (0x2341, 0x0010): "Arduino Mega 2560",
    (0x2341, 0x0042): "Arduino Mega 2560",
    (0x2A03, 0x0042): "Arduino Mega 2560",
    (0x2341, 0x8036): "Arduino Leonardo",
    (0x2341, 0x003D): "Arduino Due",
    (0x2341, 0x0058): "Arduino Nano Every",
    (0x1A86, 0x7523): "CH340 adapter",
    (0x0403, 0x6001): "FTDI adapter",
    (0x10C4, 0xEA60): "CP2102 adapter",
    (0x303A, 0x1001): "ESP32-C3",
    (0x2E8A, 0x000A): "Raspberry Pi Pico",
    (0x16C0, 0x0483): "Teensy",
    (0x1FFB, 0x00B3): "Pololu Tic T825",
    (0x1FFB, 0x00B5): "Pololu Tic T834",
    (0x1FFB, 0x00BD): "Pololu Tic T500",
    (0x1FFB, 0x00C3): "Pololu Tic N825",
    (0x1FFB, 0x00C9): "Pololu Tic T249",
    (0x1FFB, 0x00CB): "Pololu Tic 36v4",
}
"""USB vendor and product to the board or cable. They tell what is plugged in, not which firmware runs on it."""

SILICON_LABS = 0x10C4


@dataclass(frozen=True)
class Port:
    """A port that can be opened, and what people call it."""

    port: str
    name: str
    virtual: bool = False
    usb: tuple[int, int, str | None] | None = field(default=None, compare=False)
    """USB vendor, product and serial number of what is plugged in, as far as they are known and its own."""

    leads_to: str | None = field(default=None, compare=False)
    """Where its name led when that was looked at, which a link doesn't tell any more once it is gone; None: unknown."""

    @property
    def location(self) -> str:
        """Where it leads, or led, whatever name it was given; see location_of."""
        return location_of(self.port) if self.leads_to is None else self.leads_to

    @property
    def unit(self) -> tuple[int, int, str] | None:
        """USB vendor, product and serial number of what is plugged in, where they tell it from all others."""
        if self.usb is None or RemotePort.of(self.port) is not None:
            return None
        vendor, product, serial_number = self.usb
        return None if serial_number is None else (vendor, product, serial_number)

    @property
    def identity(self) -> object:
        """What tells what is plugged in apart: its USB serial number where it has one, else where the port leads."""
        return self.unit or self.location

    @property
    def board(self) -> object:
        """The same, with the kind of board where that and the port are all that is known of it."""
        return self.identity if self.unit or self.usb is None else (self.location, *self.usb[:2])

    def is_other_than(self, before: "Port") -> bool:
        """Whether another board is plugged in than before, as far as USB tells: of another kind or serial number."""
        if self.usb is None or before.usb is None:
            return False
        (*kind, number), (*former_kind, former_number) = self.usb, before.usb
        return kind != former_kind or (None not in (number, former_number) and number != former_number)

    def is_board_of(self, before: "Port") -> bool:
        """Whether the same board is plugged in as before, as far as it is told apart.

        One whose number another one has as well has none while both are there: then it is known by its place and kind.
        """
        if self.board == before.board:
            return True
        if self.usb is None or before.usb is None or (self.unit and before.unit):
            return False
        return self.location == before.location and not self.is_other_than(before)

    @property
    def called(self) -> str:
        """What tells what is plugged in apart, as people read it: its USB serial number, else its port or host."""
        if self.unit is None:
            remote = RemotePort.of(self.port)
            return self.port if remote is None else str(remote.host)
        vendor, product, serial_number = self.unit
        return f"USB {vendor:04X}:{product:04X}, serial number {escaped(serial_number)}"


_OF_WINDOWS = re.compile(r"(?:\\\\\.\\)?(?P<name>COM[0-9]+)", re.IGNORECASE)
_CALLED_IN = re.compile(r"^/dev/tty\.")
_TRAVELS = {"rfc2217": "RFC 2217", "socket": "bytes only", "moonraker": "Klipper's Moonraker"}


def list_serial_ports(remote: Iterable[RemotePort] = ()) -> list[Port]:
    """Return the ports of this machine in order of their names, then those of other machines, the virtual one last."""
    found = sorted(list_ports.comports(), key=lambda info: info.device)
    usb = [_usb_of(info) for info in found]
    real = [
        Port(info.device, _board_name(info), usb=each if usb.count(each) == 1 or each is None else (*each[:2], None))
        for info, each in zip(found, usb, strict=True)
        if _is_attached(info)
    ]
    far_away = [Port(str(each), f"{each.host} on the network, {_TRAVELS[each.scheme]}") for each in remote]
    return [*real, *far_away, Port(VIRTUAL_PORT, "Virtual (nothing attached)", virtual=True)]


def port_name(port: str) -> str:
    """Return what people call a port, also one that isn't attached: then its last part, or its address."""
    if port.startswith(VIRTUAL_PORT):
        return "Virtual controller"
    known = {listed.port: listed.name for listed in list_serial_ports()}
    last = PurePath(port).name
    # The last part of a pseudo-terminal's name is a number.
    short = f"{PurePath(port).parent.name}/{last}" if last.isdigit() else last
    return known.get(port, port if "://" in port else short)


def known_port(port: str) -> Port:
    """Return what is known of a port, so that it can be found again once it has been unplugged.

    A link to it is the same port, and called as it was asked for.
    """
    listed = {location_of(each.port): each for each in list_serial_ports() if not each.virtual}
    location = location_of(port)
    found = listed.get(location)
    known = Port(port, port_name(port)) if found is None else replace(found, port=port)
    return replace(known, leads_to=location)


def location_of(port: str) -> str:
    """Return what all names of a port have in common: links lead to one file, addresses to a host or to none.

    Windows takes COM3 in small letters, too; macOS has each port as /dev/tty.… and as /dev/cu.….
    """
    if (remote := RemotePort.of(port)) is not None:
        return str(remote.host)
    if (windows := _OF_WINDOWS.fullmatch(port)) is not None:
        return windows["name"].upper()
    is_file = port.isprintable() and "://" not in port and (os.path.isabs(port) or os.path.exists(port))
    return _CALLED_IN.sub("/dev/cu.", os.path.realpath(port)) if is_file else port


def find_again(lost: Port) -> str | None:
    """Return where a port that was lost is again; None as long as it isn't.

    A board with a USB serial number is known by that, wherever it comes back; any other, and one whose number another
    one has by now, by the name of its port, and by the kind of board, if that was known.
    """
    if "://" in lost.port:
        return lost.port if not lost.port.startswith(VIRTUAL_PORT) or registered(lost.port) else None
    if lost.usb is None:
        return lost.port if PurePath(lost.port).is_absolute() and Path(lost.port).exists() else None
    listed = [each for each in list_serial_ports() if each.usb is not None]
    if lost.unit and (alike := [each.port for each in listed if each.unit == lost.unit]):
        return alike[0]
    there = location_of(lost.port)
    is_there = any(location_of(each.port) == there and not each.is_other_than(lost) for each in listed)
    return lost.port if is_there else None


def _usb_of(info: ListPortInfo) -> tuple[int, int, str | None] | None:
    if info.vid is None or info.pid is None:
        return None
    # Most adapters with a CP210x have the serial number that Silicon Labs delivers: it tells none from another.
    is_own = (info.vid, info.serial_number) != (SILICON_LABS, "0001")
    return info.vid, info.pid, info.serial_number if is_own else None


def _is_attached(info: ListPortInfo) -> bool:
    """Leave out the ttyS* that Linux lists whether they exist or not: they have neither vendor nor description."""
    return info.vid is not None or info.description not in (None, "", "n/a")


def _board_name(info: ListPortInfo) -> str:
    short = PurePath(info.device).name
    board = None if info.vid is None or info.pid is None else BOARDS.get((info.vid, info.pid))
    # What a board says of itself is UTF-16 on some systems, which may be half of a pair.
    name = board or (info.description and escaped(info.description))
    return short if name in (None, "", "n/a", short) else f"{name} on {short}"
