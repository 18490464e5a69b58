"""What grbl 1.1 says, and what it means to people: its interface, commands and codes, as its documentation has them."""

import re
from dataclasses import dataclass
from enum import StrEnum

STATUS, HOLD, RESUME, JOG_CANCEL, RESET = b"?", b"!", b"~", b"\x85", b"\x18"
"""Real-time commands: a byte each, which is obeyed at once and is no part of a line."""
LONGEST_LINE = 79
"""Of 80 characters, one ends it."""
MOST_TOLD = 1e9
"""No place and no feed that is told is more, nor is none [mm, mm/min]."""
_OBEYED_AT_ONCE = frozenset("?!~")
_HARMLESS = re.compile(r"(?:G(?:17|18|19|20|21|54|55|56|57|58|59|90|91|93|94))*", re.IGNORECASE)

_BANNER = re.compile(r"Grbl(?P<hal>HAL)? (?P<version>\d+\.\d+\w?) \[(?P<rest>.*)\]", re.IGNORECASE)
_REPORT = re.compile(r"[?]*<(?P<state>[A-Z][A-Za-z]+)(?::(?P<part>\d{1,3}))?\|(?P<fields>[^<>]*)>")
_VERDICT = re.compile(r"(?P<word>ok|error|ALARM)(?::(?P<code>\d{1,3}))?")


class State(StrEnum):
    """What a grbl does as a whole."""

    IDLE = "Idle"
    RUN = "Run"
    JOG = "Jog"
    HOLD = "Hold"
    ALARM = "Alarm"
    DOOR = "Door"
    CHECK = "Check"
    HOME = "Home"
    SLEEP = "Sleep"
    TOOL = "Tool"


@dataclass(frozen=True)
class Banner:
    """What it says of itself once it has started."""

    version: str
    is_hal: bool
    rest: str

    @property
    def is_of_fluidnc(self) -> bool:
        """Whether it is a FluidNC, which begins as grbl does."""
        return "fluidnc" in self.rest.lower()


@dataclass(frozen=True)
class Report:
    """Its answer to a question mark; lengths as $13 has them, in mm or inches."""

    state: State
    part: int
    """Hold:0 has come to rest, Hold:1 has not; likewise with Door. Of Alarm, which one grblHAL is in; 0: not told."""
    position: tuple[float, ...]
    is_of_work: bool
    """The position counts from where the workpiece is, so that the offset is to be added."""
    offset: tuple[float, ...] | None
    """Of the workpiece; told now and then only."""
    feed_per_min: float

    @property
    def is_under_way(self) -> bool:
        """Whether motors may move."""
        return self.state in (State.RUN, State.JOG, State.HOME) or (
            self.state in (State.HOLD, State.DOOR) and self.part in ((1,) if self.state is State.HOLD else (2, 3))
        )


@dataclass(frozen=True)
class Verdict:
    """How it takes a line, ok or error; or an alarm."""

    word: str
    code: int


def moves_nothing(block: str) -> bool:
    """Tell whether a start-up line is one by which nothing moves or turns."""
    return _HARMLESS.fullmatch(block.replace(" ", "")) is not None


def is_sendable(line: str) -> bool:
    """Tell whether a text arrives as one line: none of its characters is obeyed at once, and it is not too long."""
    return line.isascii() and line.isprintable() and len(line) <= LONGEST_LINE and not _OBEYED_AT_ONCE & set(line)


def banner_of(line: str) -> Banner | None:
    """Return what a line says of a start; None for any other line."""
    found = _BANNER.fullmatch(line)
    return None if found is None else Banner(found["version"], found["hal"] is not None, found["rest"])


def is_banner_of_grbl(line: str) -> bool:
    """Tell whether a line is that with which a grbl or a grblHAL starts."""
    return (banner := banner_of(line)) is not None and not banner.is_of_fluidnc


def is_banner_of_fluidnc(line: str) -> bool:
    """Tell whether a line is that with which a FluidNC starts, which calls itself a grbl, too."""
    return (banner := banner_of(line)) is not None and banner.is_of_fluidnc


def verdict_of(line: str) -> Verdict | None:
    """Return the verdict that a line is; None for any other line."""
    found = _VERDICT.fullmatch(line)
    return None if found is None else Verdict(found["word"], int(found["code"] or 0))


def report_of(line: str) -> Report | None:
    """Return the report that a line is; None for any other line, and for a damaged one."""
    found = _REPORT.fullmatch(line)
    if found is None or found["state"] not in list(State):
        return None
    pairs = [each.partition(":") for each in found["fields"].split("|")]
    fields = {name: value for name, _, value in pairs}
    try:
        position = _numbers(fields["MPos"] if "MPos" in fields else fields["WPos"])
        offset = _numbers(fields["WCO"]) if "WCO" in fields else None
        feed = _numbers(fields.get("FS", fields.get("F", "0")))[0]
    except (KeyError, ValueError):
        return None
    if offset is not None and len(offset) != len(position):
        return None
    return Report(State(found["state"]), int(found["part"] or 0), position, "MPos" not in fields, offset, feed)


def _numbers(text: str) -> tuple[float, ...]:
    numbers = tuple(float(each) for each in text.split(","))
    if not all(abs(each) <= MOST_TOLD for each in numbers):
        raise ValueError("what no machine tells")
    return numbers


ERROR_WORDS = {
    1: "it expected a letter",
    2: "a number is missing or malformed",
    3: "it knows no such statement",
    4: "a value may not be negative",
    5: "homing is not enabled",
    6: "a step pulse must last at least 3 µs",
    7: "its EEPROM could not be read, so it has gone back to its defaults",
    8: "it takes that only at rest",
    9: "it is locked",
    10: "soft limits need homing to be enabled",
    11: "the line is too long",
    12: "the step rate would be higher than it can make",
    13: "its safety door is open",
    14: "the line is too long for its EEPROM",
    15: "the way leads beyond its soft limits",
    16: "a jog needs a way and a feed",
    17: "laser mode needs PWM",
    20: "it knows no such command",
    22: "no feed is set",
    23: "the number must be whole",
    52: "the value is out of its range",
}
ALARM_WORDS = {
    1: "a limit switch was hit, so its position may be lost",
    2: "a way would have led beyond its soft limits",
    3: "it was reset while it moved, so its position may be lost",
    4: "its probe was not as expected",
    5: "its probe met nothing",
    6: "homing was cut short by a reset",
    7: "homing was cut short by the safety door",
    8: "homing didn't come free of the limit switch",
    9: "homing found no limit switch",
    10: "its emergency stop is pressed",
    11: "it has to be homed first",
}
DEAF_ALARMS = (1, 2)
"""After these it takes no line until it is reset."""
STATE_WORDS = {
    State.RUN: "it carries out a program that somebody else has started",
    State.HOLD: "it was put on hold at the machine",
    State.DOOR: "its safety door is open",
    State.CHECK: "it is in check mode, in which nothing moves ($C ends that)",
    State.HOME: "it is homing",
    State.SLEEP: "it sleeps until it is reset",
    State.TOOL: "it waits for a tool to be changed",
}


def error_words(code: int) -> str:
    """Return what an error means, as part of a sentence."""
    return f"{ERROR_WORDS[code]} (error:{code})" if code in ERROR_WORDS else f"error:{code}"


def alarm_words(code: int | None) -> str:
    """Return what an alarm means, as part of a sentence; None: one of which the code isn't known."""
    if code is None:
        return "it is locked since it was started, or since an alarm"
    return f"{ALARM_WORDS[code]} (ALARM:{code})" if code in ALARM_WORDS else f"ALARM:{code}"
