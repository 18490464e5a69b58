"""A backup of a Marlin: the commands that it lists, and those of them that can be written again."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stepramp.controllers.given_numbers import as_float32
from stepramp.controllers.marlin.settings import (
    ACCELERATION,
    ACCELERATIONS,
    DECIMALS,
    LETTERS,
    SPEED,
    STEPS_PER_MM,
    Settings,
    is_rounded,
)
from stepramp.controllers.remark import UNLIKE
from stepramp.errors import Count, Rejected, Rejection

ALLOWED = "a backup of a Marlin: the lines that it tells after M503"
WRITABLE = frozenset(
    f"M{number}"
    for number in (
        *(92, 145, 200, 201, 203, 204, 205, 206, 207, 208, 209, 217, 218, 281, 301, 304, 309, 412, 413, 414, 420, 421),
        *(425, 569, 593, 603, 665, 666, 851, 852, 871, 900, 906, 907, 913, 914, 919),
    )
)
"""Commands that set something, by which nothing moves."""
ABOVE_ZERO = (STEPS_PER_MM, ACCELERATION, SPEED)
LEAST = {STEPS_PER_MM: ("XYZE", 0.0), SPEED: ("XYZE", 0.01), ACCELERATION: ("XYZE", 1.0), ACCELERATIONS: ("PRT", 1.0)}
"""Letters of commands, and the least that they may have: [steps/mm], above 0; [mm/s]; [mm/s²]."""
MODES = frozenset({"G20", "G21", "M149"})
"""How it tells numbers, not what it keeps."""


@dataclass(frozen=True)
class Backup:
    """What a text tells."""

    settings: Settings

    @classmethod
    def of(cls, text: str) -> "Backup":
        """Return it; Rejected for a text that tells no axes, or a setting with which none could be moved."""
        lines = text.splitlines()
        settings = Settings.of(lines)
        if not settings.axes():
            told = {code for code, _ in settings.commands}
            bad = _senseless(settings) if told >= set(ABOVE_ZERO) else []
            raise Rejected(bad or [Rejection("text", Count(f"{len(lines)} lines"), ALLOWED)])
        if bad := _senseless(settings):
            raise Rejected(bad)
        if settings.is_in_inches:
            raise Rejected([Rejection("text", "G20", "a backup in mm (G21)")])
        if settings.is_of_marlin_1_0:
            words = " ".join(f"{letter}{value}" for letter, value in settings.words(ACCELERATIONS).items())
            allowed = "a backup of a Marlin from 1.1 on: there T is for travel, in 1.0 for retracts"
            raise Rejected([Rejection("text", f"{ACCELERATIONS} {words}", allowed)])
        return cls(settings)

    def lines(self, present: "Backup") -> list[str]:
        """Return the lines that make what is present what was backed up: only what differs."""
        return [f"{code} {words}" for code, words in self._differing(present) if code in WRITABLE]

    def rounded(self, present: "Backup") -> Iterator[str]:
        """Yield which steps per mm are written that may have been others, as sentences."""
        there = present.settings.words(STEPS_PER_MM)
        for letter, value in self.settings.words(STEPS_PER_MM).items():
            if letter in LETTERS and there.get(letter) != value and is_rounded(as_float32(value)):
                yield (
                    f"M92 {letter}{value} is what Marlin told, rounded to two decimals: where it was set to more, set "
                    "that again."
                )

    def is_unwritten(self, present: "Backup") -> bool:
        """Tell whether something that is kept there, and could be written, is not as in the backup."""
        kept = {code for code, _ in present.settings.commands}
        return any(code in WRITABLE and code in kept for code, _ in self._differing(present))

    def left(self, present: "Backup") -> Iterator[str]:
        """Yield what is not as in the backup, as sentences."""
        for code, words in self._differing(present):
            able = UNLIKE if code in WRITABLE else "can't be written again."
            yield f"{code} {words} {able}"

    def _differing(self, present: "Backup") -> Iterator[tuple[str, str]]:
        there = {_meaning(*each) for each in present.settings.commands}
        for each in self.settings.commands:
            if _meaning(*each) not in there and each[0] not in MODES:
                yield each


def _meaning(code: str, words: str) -> tuple[str, ...]:
    """Return what a command sets, however many decimals are written."""
    return (code, *(f"{word[0]}{float(word[1:] or 0):.{DECIMALS}f}" for word in words.split()))


def _senseless(settings: Settings) -> list[Rejection]:
    """Return what is told twice, and differently, and what no axis could be moved with."""
    return list(_told_twice(settings)) or list(_too_little(settings))


def _told_twice(settings: Settings) -> Iterator[Rejection]:
    """Yield what is told twice, and differently: which of both it was nobody knows, and both would be written."""
    told: dict[str, dict[float, str]] = {}
    for name, value, _ in _told(settings):
        told.setdefault(name, {}).setdefault(float(value), value)
    for name, values in told.items():
        if len(values) > 1:
            yield Rejection(name, Count(" and ".join(values.values())), "each setting once in a backup")


def _too_little(settings: Settings) -> Iterator[Rejection]:
    for name, value, least in dict.fromkeys(_told(settings)):
        if not _is_at_least(value, least):
            allowed = f"at least {least:g}: it would be told, or taken, as 0"
            yield Rejection(name, value, allowed if least else "a number above 0: the axis couldn't be moved without")


def _told(settings: Settings) -> Iterator[tuple[str, str, float]]:
    """Yield each number of LEAST by its name, such as M92 X, or M92 T1 E of a further extruder, and its least."""
    for code, numbers in settings.numbers():
        letters, least = LEAST.get(code, ("", 0.0))
        others = [f"T{value} " for letter, value in numbers if letter == "T" and value != "0" and code != ACCELERATIONS]
        yield from (
            (f"{code} {''.join(others)}{letter}", value, least) for letter, value in numbers if letter in letters
        )


def _is_at_least(value: str, least: float) -> bool:
    try:
        return bool(as_float32(value) > 0 and as_float32(value) >= np.float32(least))
    except (ValueError, OverflowError):
        return False
