"""A backup of a grbl: what it told of itself, as lines, and those of it that can be written again.

grbl carries a start-up line out before it stores it. So one that may move something is never sent.
"""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

from stepramp.controllers.grbl.dialect import is_sendable, moves_nothing
from stepramp.controllers.grbl.numbers import read
from stepramp.controllers.grbl.ramp import MOST
from stepramp.controllers.grbl.settings import (
    LETTERS,
    MOST_RATE,
    REPORTS_INCHES,
    SOFT_LIMITS,
    STEPS_PER_MM,
    TRAVEL,
    Settings,
    is_told_same,
)
from stepramp.controllers.order import lowered_first
from stepramp.errors import Count, Rejected, Rejection

_PLACE = re.compile(r"\[G(?P<code>5[4-9]):(?P<numbers>[-\d.,]+)\]")
_ANY_PLACE = re.compile(r"\[G5[4-9](?![.\d])")
"""How its line begins, whatever has become of the rest; grblHAL's G59.1 is another."""
_STARTUP = re.compile(r"\$N(?P<number>[01])=(?P<block>.*)")
_NAME = re.compile(r"[$](?:\d{1,4}|N[01])")
"""Of a setting or a start-up line."""
_HIDDEN = re.compile(r"[*]+")
"""What grblHAL tells in place of a password."""
ALLOWED = "a backup of a grbl: the lines that it tells after $$"
NOT_WRITTEN = "What G28 and G30 go to can't be written again: go there, and say G28.1 or G30.1."


@dataclass(frozen=True)
class Entry:
    """Something that differs. line: what makes it what was backed up."""

    name: str
    line: str
    obstacle: str | None = None
    """Why it isn't sent, as a sentence; None: it is."""


@dataclass(frozen=True)
class Backup:
    """What can be written again."""

    settings: Settings
    startup: dict[str, str]
    """Start-up lines by their number."""
    offsets: dict[str, str]
    """Offsets of workpieces by their code, 54 to 59, as words of axes."""

    @classmethod
    def of(cls, text: str) -> "Backup":
        """Return what a text tells; Rejected when it tells no settings, or one that grbl would hang with."""
        backup = cls.told(text)
        if not backup.settings.values:
            raise Rejected([Rejection("text", Count(f"{len(text.splitlines())} lines"), ALLOWED)])
        bad = [*_told_twice(text), *_senseless(backup.settings), *_senseless_places(text, backup.settings)]
        if not bad and backup.settings.axis(0) is None:
            bad = [Rejection("text", Count(f"{len(text.splitlines())} lines"), ALLOWED)]
        if bad:
            raise Rejected(bad)
        return backup

    @classmethod
    def told(cls, text: str) -> "Backup":
        """Return what a text tells, whether it makes sense or not: a power cut may have left anything."""
        lines = [line.strip() for line in text.splitlines()]
        startup = {found["number"]: found["block"] for found in map(_STARTUP.fullmatch, lines) if found is not None}
        places = {found["code"]: found["numbers"] for found in map(_PLACE.fullmatch, lines) if found is not None}
        offsets = {code: _words(numbers) for code, numbers in places.items()}
        return cls(Settings.of(lines), startup, offsets)

    def differing(self, present: "Backup") -> Iterator[Entry]:
        """Yield what is present as something else, in the order in which it is written: settings first.

        Soft limits come last of those, since grbl takes them only once homing is set.
        """
        numbers = lowered_first(self.settings.values, lambda number: self._raises(number, present))
        for number in sorted(numbers, key=lambda number: number == SOFT_LIMITS):
            value = self.settings.values[number]
            if not is_told_same(present.settings.values.get(number), value):
                yield _entry(f"${number}", f"${number}={value}", is_hidden=_HIDDEN.fullmatch(value) is not None)
        units = "G20" if self.settings.number(REPORTS_INCHES) else "G21"
        for code, words in self.offsets.items():
            if present.offsets.get(code) != words:
                yield _entry(f"G{code}", f"{units}G10L2P{int(code) - 53}{words}")
        for place, block in self.startup.items():
            if present.startup.get(place) != block:
                yield _entry(f"$N{place}", f"$N{place}={block}", moves=not moves_nothing(block))

    def lacking(self, present: "Backup") -> Iterator[str]:
        """Yield the names of what a controller has, and this doesn't tell of."""
        yield from (f"${number}" for number in present.settings.values if number not in self.settings.values)
        yield from (f"G{code}" for code in present.offsets if code not in self.offsets)
        yield from (f"$N{place}" for place in present.startup if place not in self.startup)

    def _raises(self, number: int, present: "Backup") -> bool:
        """Whether an axis gets a higher rate or acceleration than is present."""
        is_limit = MOST_RATE <= number < TRAVEL
        return is_limit and self.settings.number(number) > present.settings.number(number)


def _entry(name: str, line: str, *, is_hidden: bool = False, moves: bool = False) -> Entry:
    if is_hidden:
        return Entry(name, line, f"{name} isn't written again: the controller tells asterisks in place of its value.")
    if moves:
        why = "grbl carries a start-up line out as it stores it, and this one may move something"
        return Entry(name, line, f"{line} isn't written again: {why}. Say it at the machine.")
    if not is_sendable(line):
        return Entry(name, line, f"{name} isn't written again: it is too long, or has characters that grbl obeys.")
    return Entry(name, line)


def _told_twice(text: str) -> Iterator[Rejection]:
    """Yield what a text tells twice, and differently: which of both it was nobody knows."""
    values: dict[str, dict[str, None]] = {}
    for name, value in filter(None, map(_named, map(str.strip, text.splitlines()))):
        values.setdefault(name, {})[value] = None
    for name, told in values.items():
        if len(told) > 1:
            yield Rejection(name, Count(" and ".join(told)), "each setting once in a backup")


def _named(line: str) -> tuple[str, str] | None:
    """Return what a line tells by a name, without the comment behind it; None where it tells nothing."""
    if (place := _PLACE.fullmatch(line)) is not None:
        return f"G{place['code']}", place["numbers"]
    name, _, value = line.partition("=")
    if _NAME.fullmatch(name) is None:
        return None
    return name, value.partition("(")[0].rstrip(" ") if line.endswith(")") else value


def _senseless(settings: Settings) -> Iterator[Rejection]:
    """Yield settings of axes with which grbl would hang, or that no machine has."""
    for number, text in settings.values.items():
        if STEPS_PER_MM <= number < TRAVEL + 10:
            value = _number(text)
            if number < TRAVEL and not value > 0:
                yield Rejection(f"${number}", text, "a number above 0: grbl hangs without")
            # NaN is no more than anything.
            elif not abs(value) <= MOST:
                yield Rejection(f"${number}", text, f"a number up to {MOST:,}: no machine has more")


def _senseless_places(text: str, settings: Settings) -> Iterator[Rejection]:
    """Yield lines of offsets that no grbl with so many axes tells: what it would make of them nobody knows."""
    axes = sum(number in settings.values for number in range(STEPS_PER_MM, STEPS_PER_MM + len(LETTERS)))
    lines = [line for line in map(str.strip, text.splitlines()) if _ANY_PLACE.match(line)]
    told = {line: [_number(each) for each in _numbers(line)] for line in lines}
    counts = {len(numbers) for numbers in told.values()}
    # Of more axes than there are settings of, where somebody has taken those out.
    count = counts.pop() if len(counts) == 1 and max(counts) > axes else axes
    for line, numbers in told.items():
        # NaN is no less than anything.
        if len(numbers) != count or not all(abs(each) <= MOST for each in numbers):
            code = line[1:4]
            yield Rejection(code, line, f"[{code}:…] with {count} numbers up to {MOST:,}, one for each axis")


def _numbers(line: str) -> list[str]:
    """Return the numbers of a line of offsets; none of one that is broken."""
    place = _PLACE.fullmatch(line)
    return [] if place is None else place["numbers"].split(",")


def _number(text: str) -> float:
    """Return a setting as a number; NaN for what is none."""
    try:
        return float(read(text))
    except ValueError:
        return math.nan


def _words(numbers: str) -> str:
    return "".join(letter + number for letter, number in zip(LETTERS, numbers.split(","), strict=False))
