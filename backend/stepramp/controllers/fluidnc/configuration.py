"""FluidNC's configuration, as its `$CD` tells it and its file has it: items in sections, by indentation.

It is no YAML, though it looks like that: a value is all that stands behind its colon, and `8E1` is no number. So it is
read here as FluidNC reads it.
"""

import re
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from stepramp.controllers.given_numbers import may_be_told
from stepramp.controllers.grbl.settings import REPORTS_INCHES, STAYS_ON, AxisSettings, rounding_slack

LETTERS = "xyzabc"
ITEMS = ("steps_per_mm", "max_rate_mm_per_min", "acceleration_mm_per_sec2")
"""Of an axis: those that make its ramp."""
LEAST, MOST = 0.001, 100_000.0
"""No item of these is less, or more: FluidNC puts what is beyond to that."""
AT_START, AT_UNLOCKING = ("startup_line0", "startup_line1", "after_reset"), ("after_unlock",)
"""Macros that are carried out by themselves."""
HARMLESS = re.compile(r"(?:G(?:17|18|19|20|21|54|55|56|57|58|59|90|91|93|94)|&|\s)*", re.IGNORECASE)
"""Macros by which nothing moves or turns."""
_ITEM = re.compile(r"(?P<blanks> *)(?P<name>[^\s:#\[$;][^:#]*):(?P<value>\s.*)?")
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)", re.ASCII)
_DEFAULTS = {"steps_per_mm": "80", "max_rate_mm_per_min": "1000", "acceleration_mm_per_sec2": "25"}
"""What FluidNC takes for an item that isn't there."""


@dataclass(frozen=True)
class Configuration:
    """The items of a configuration, by their paths, such as axes/x/steps_per_mm, in lower case."""

    items: Mapping[str, str]
    sections: frozenset[str]
    twice: Mapping[str, str]
    """Paths that were told once more, with another value than in items: that."""
    exact: frozenset[str] = frozenset()
    """Paths of numbers that aren't rounded."""

    @classmethod
    def of(cls, lines: Iterable[str]) -> "Configuration":
        """Return what lines tell; those that tell no item are left out."""
        items: dict[str, str] = {}
        twice: dict[str, str] = {}
        above: list[tuple[int, str]] = []
        for line in lines:
            found = _ITEM.fullmatch(line)
            if found is None:
                continue
            indent = len(found["blanks"])
            while above and above[-1][0] >= indent:
                above.pop()
            path = "/".join([*(name for _, name in above), found["name"].strip().lower()])
            value = (found["value"] or "").strip().strip("'\"")
            if items.get(path, value) != value:
                twice[path] = items[path]
            items[path] = value
            above.append((indent, path.rpartition("/")[2]))
        return cls(items, frozenset(path.rpartition("/")[0] for path in items), twice)

    @property
    def axes(self) -> list[str]:
        """The letters of the axes that it has, from the first one on without a gap."""
        found = []
        for letter in LETTERS:
            if f"axes/{letter}" not in self.sections:
                break
            found.append(letter)
        return found

    def axis(self, axis: int) -> AxisSettings | None:
        """Return what is kept of an axis; None when it isn't there, or makes no sense."""
        if axis >= len(self.axes):
            return None
        told = (self.items.get(f"axes/{LETTERS[axis]}/{item}", "").partition("#")[0] for item in ITEMS)
        texts = [text or _DEFAULTS[item] for text, item in zip(told, ITEMS, strict=True)]
        if not all(map(_makes_sense, texts)):
            return None
        is_exact = self.scale_name(axis) in self.exact
        scale, rate, gain = map(np.float32, map(float, texts))
        return AxisSettings(scale, rate, gain, 0.0 if is_exact else rounding_slack(texts[0].strip()))

    def untold(self, axis: int) -> list[str]:
        """Return which items of an axis aren't there, and what is taken for them, as beginnings of sentences."""
        paths = {item: f"axes/{LETTERS[axis]}/{item}" for item in ITEMS}
        return [
            f"{path} is taken as {_DEFAULTS[item]}"
            for item, path in paths.items()
            if not self.items.get(path, "").partition("#")[0]
        ]

    def senseless(self, axis: int) -> str | None:
        """Return the first item of an axis with which it makes no sense, as it is told."""
        for item in ITEMS:
            text = self.items.get(path := f"axes/{LETTERS[axis]}/{item}", "").partition("#")[0].strip()
            if text and not _makes_sense(text):
                return f"{path}: {text}"
        return None

    def with_scales_of(self, file: "Configuration") -> "Configuration":
        """Return the same with the steps per mm of the file, where they may be those: `$CD` tells them rounded."""
        items, exact = dict(self.items), self.exact
        for axis, letter in enumerate(self.axes):
            there, told = file.axis(axis), self.items.get(path := f"axes/{letter}/steps_per_mm", "")
            with suppress(ValueError):
                if there is not None and path in file.items and may_be_told(told, float(there.steps_per_mm)):
                    items[path], exact = file.items[path].partition("#")[0].strip(), exact | {path}
        return replace(self, items=items, exact=exact)

    def number(self, number: int) -> float:
        """Return what grbl has as a setting of this number; 0 for others than are asked for."""
        if number == REPORTS_INCHES:
            return float(self.items.get("report_inches", "").lower() == "true")
        if number == STAYS_ON:
            text = self.items.get("stepping/idle_ms", "")
            return float(text) if text.isascii() and text.isdigit() else 0.0
        return 0.0

    def scale_name(self, axis: int) -> str:
        """Return the path of the steps per mm of an axis."""
        return f"axes/{LETTERS[axis]}/steps_per_mm"

    def carries_out(self, macros: Iterable[str]) -> bool:
        """Whether one of some macros may move something."""
        return not all(HARMLESS.fullmatch(self.items.get(f"macros/{name}", "")) for name in macros)


def _makes_sense(text: str) -> bool:
    return _NUMBER.fullmatch(text.strip()) is not None and LEAST <= float(text) <= MOST
