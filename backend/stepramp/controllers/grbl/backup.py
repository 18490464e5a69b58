"""A backup of a grbl: what it told of itself, as lines, and those of it that can be written again."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from stepramp.controllers.grbl.numbers import read
from stepramp.controllers.grbl.settings import LETTERS, REPORTS_INCHES, Settings
from stepramp.errors import Rejected, Rejection

_PLACE = re.compile(r"\[G(?P<code>5[4-9]):(?P<numbers>[-\d.,]+)\]")
_STARTUP = re.compile(r"\$N(?P<number>[01])=(?P<block>.*)")
ALLOWED = "a backup of a grbl: the lines that it tells after $$"
NOT_WRITTEN = "What G28 and G30 go to can't be written again: go there, and say G28.1 or G30.1."


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
        lines = [line.strip() for line in text.splitlines()]
        settings = Settings.of(lines)
        if settings.axis(0) is None:
            raise Rejected([Rejection("text", f"{len(lines)} lines", ALLOWED)])
        bad = [
            Rejection(f"${number}", value, "a number above 0: grbl hangs without")
            for number, value in settings.values.items()
            if 100 <= number < 130 and not _is_positive(value)
        ]
        if bad:
            raise Rejected(bad)
        startup = {found["number"]: found["block"] for found in map(_STARTUP.fullmatch, lines) if found is not None}
        places = {found["code"]: found["numbers"] for found in map(_PLACE.fullmatch, lines) if found is not None}
        return cls(settings, startup, {code: _words(numbers) for code, numbers in places.items()})

    def lines(self, present: "Backup") -> Iterator[str]:
        """Yield the lines that make what is present what was backed up: only what differs, settings first."""
        for number, value in self.settings.values.items():
            if present.settings.values.get(number) != value:
                yield f"${number}={value}"
        units = "G20" if self.settings.number(REPORTS_INCHES) else "G21"
        for code, words in self.offsets.items():
            if present.offsets.get(code) != words:
                yield f"{units}G10L2P{int(code) - 53}{words}"
        for place, block in self.startup.items():
            if present.startup.get(place) != block:
                yield f"$N{place}={block}"


def _is_positive(value: str) -> bool:
    try:
        return bool(read(value) > 0)
    except ValueError:
        return False


def _words(numbers: str) -> str:
    return "".join(letter + number for letter, number in zip(LETTERS, numbers.split(","), strict=False))
