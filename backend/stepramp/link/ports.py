"""The serial ports of this machine, with names that people know."""

from dataclasses import dataclass
from pathlib import PurePath

from serial.tools import list_ports
from serial.tools.list_ports_common import ListPortInfo

from stepramp.link.protocol_sim import VIRTUAL_PORT

BOARDS = {
    (0x2341, 0x0043): "Arduino Uno",
    (0x2341, 0x0001): "Arduino Uno",
    (0x2A03, 0x0043): "Arduino Uno",
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


@dataclass(frozen=True)
class Port:
    """A port that can be opened, and what people call it."""

    port: str
    name: str
    virtual: bool = False


def list_serial_ports() -> list[Port]:
    """Return the ports of this machine in order of their names, the virtual one last."""
    found = sorted(list_ports.comports(), key=lambda info: info.device)
    real = [Port(info.device, _board_name(info)) for info in found if _is_attached(info)]
    return [*real, Port(VIRTUAL_PORT, "Virtual controller (nothing attached)", virtual=True)]


def port_name(port: str) -> str:
    """Return what people call a port, also one that isn't attached: then its last part, or its address."""
    if port.startswith(VIRTUAL_PORT):
        return "Virtual controller"
    known = {listed.port: listed.name for listed in list_serial_ports()}
    return known.get(port, port if "://" in port else PurePath(port).name)


def _is_attached(info: ListPortInfo) -> bool:
    """Leave out the ttyS* that Linux lists whether they exist or not: they have neither vendor nor description."""
    return info.vid is not None or info.description not in (None, "", "n/a")


def _board_name(info: ListPortInfo) -> str:
    short = PurePath(info.device).name
    board = None if info.vid is None or info.pid is None else BOARDS.get((info.vid, info.pid))
    name = board or info.description
    return short if name in (None, "", "n/a", short) else f"{name} on {short}"
