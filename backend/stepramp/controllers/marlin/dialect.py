"""What Marlin says and is told, line by line, as its G-code documentation has it (https://marlinfw.org/meta/gcode)."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import reduce
from operator import xor

QUICK_STOP = "M410"
"""Ends all steps at once, and drops what is planned; obeyed as soon as it is read, but only without a line number."""
KILL = "M112"
"""Ends everything, heaters too, until the machine is reset."""
IDENTIFY, POSITION, LIVE_POSITION, SETTINGS = "M115", "M114", "M114 R", "M503"
ENDSTOPS = "M119"
"""What is answered at once, in words, also while something moves."""
AWAIT_REST, STORE, LOAD, PRINTING = "M400", "M500", "M501", "M27"
RELATIVE, ABSOLUTE, MOTION = "G91", "G90", "G1 "
FIRST_LINE = "M110 N0"
"""Has it count lines from 0."""

OK = re.compile(r"ok\b.*")
RESEND = re.compile(r"(?:Resend:|rs) *N?(?P<number>\d+)")
TRANSFER_FAULT = re.compile(r"Error: ?(?:checksum mismatch|Line Number|No (?:Checksum|Line Number))", re.IGNORECASE)
ERROR = re.compile(r"Error: ?(?P<words>.*)")
UNKNOWN = re.compile(r"echo: ?Unknown command: \"?(?P<line>[^\"]*)\"?.*")
BUSY = re.compile(r"(?:echo:)?busy: .*")
START = re.compile(r"start")
BANNER = re.compile(r"(?:echo:)? ?Marlin (?:bugfix-)?\d.*")
"""What it says of itself while it starts."""
CHATTER = re.compile(r"wait|//.*|(?:T\d?|B):.*")
"""What it says unasked: temperatures, words to the host's screen."""
NO_EXTRUSION = re.compile(r"(?:echo:)? ?(?P<words>(?:cold|too long|long) extrusion prevented.*)", re.IGNORECASE)
PRINTS = re.compile(r"SD printing byte .*")
NOT_PRINTING = re.compile(r"Not SD printing.*")

_FIRMWARE = re.compile(r"FIRMWARE_NAME: ?(?P<name>.*?)(?: SOURCE_CODE_URL:.*| FIRMWARE_URL:.*)?")
_MARLIN = re.compile(r"Marlin(?: V?(?P<version>[\w.+-]+))?(?: .*)?")
_CAPABILITY = re.compile(r"Cap:(?P<name>\w+):(?P<has>[01])")
_NUMBER = re.compile(r"(?P<letter>[A-Z]): *(?P<value>-?\d{1,10}(?:\.\d+)?)(?![\d.])")


@dataclass(frozen=True)
class Place:
    """Where the axes are, as M114 tells."""

    lengths: Mapping[str, float]
    """By letter [mm], to hundredths."""
    counts: Mapping[str, int]
    """By letter [steps]; the extruder isn't counted there."""


def numbered(number: int, line: str) -> str:
    """Return a line with its number and the exclusive or of all that comes before its asterisk.

    >>> numbered(3, "M201 X500")
    'N3 M201 X500*110'
    """
    text = f"N{number} {line}"
    return f"{text}*{reduce(xor, text.encode())}"


def is_banner(line: str) -> bool:
    """Tell whether a line is what a Marlin says of itself while it starts."""
    return BANNER.fullmatch(line) is not None


def place_of(line: str) -> Place | None:
    """Return the place that a line tells; None for any other line."""
    told, separator, counted = line.partition(" Count")
    if not separator or not line.startswith("X:"):
        return None
    lengths = {each["letter"]: float(each["value"]) for each in _NUMBER.finditer(told)}
    counts = {each["letter"]: int(float(each["value"])) for each in _NUMBER.finditer(counted)}
    return Place(lengths, counts) if lengths and counts else None


def firmware_of(line: str) -> str | None:
    """Return the name of the firmware that a line tells; None for any other line."""
    found = _FIRMWARE.fullmatch(line)
    return None if found is None else found["name"].strip()


def marlin_version(firmware: str) -> str | None:
    """Return the version of a firmware that is Marlin, "" for one that doesn't tell; None for any other firmware."""
    found = _MARLIN.fullmatch(firmware)
    return None if found is None else found["version"] or ""


def capability_of(line: str) -> tuple[str, bool] | None:
    """Return what a line tells of what the firmware was built with."""
    found = _CAPABILITY.fullmatch(line)
    return None if found is None else (found["name"], found["has"] == "1")
