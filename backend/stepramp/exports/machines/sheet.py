"""What comes of a design for such a machine: a text, its figures, and what people should know."""

from collections.abc import Iterable
from dataclasses import dataclass
from textwrap import wrap
from typing import Literal, get_args

from stepramp.controllers.remark import told_in
from stepramp.design import Design
from stepramp.errors import Rejected, Rejection, Told
from stepramp.exports.names import comment_text
from stepramp.version import __version__

AxisLetter = Literal["X", "Y", "Z", "A", "B", "C"]
LETTERS: tuple[AxisLetter, ...] = get_args(AxisLetter)
"""In the order in which machines number their axes."""
WIDTH = 84
"""Of comments [characters]."""

_ASCII = str.maketrans({"²": "^2", "³": "^3", "µ": "u", "·": "*", "×": "x", "–": "-", "—": "-", "’": "'", "…": "..."})
_AT_ONCE = "?!~"
"""grbl and its kin obey these wherever they stand, in comments too."""


@dataclass(frozen=True)
class Setting:
    """One figure of a machine."""

    name: str
    """As the machine calls it."""
    unit: str
    requested: float
    """What the design asks for, before it was rounded [unit]."""
    sent: str


@dataclass(frozen=True)
class Sheet:
    """All of it."""

    text: str
    settings: tuple[Setting, ...]
    remarks: tuple[str, ...]
    """What of the design is lost, and what else there is to know, as sentences."""

    @property
    def remarks_told(self) -> tuple[tuple[Told, ...], ...]:
        """The quantities of each remark that a design's axis converts."""
        return told_in(self.remarks)


def harmless(text: str) -> str:
    """Return a text in printable ASCII that no machine obeys: for comments.

    >>> harmless("5 µs at 3 steps/s²! 日")
    '5 us at 3 steps/s^2_ _'
    """
    known = text.translate(_ASCII)
    return comment_text("".join(each if " " <= each < "\x7f" and each not in _AT_ONCE else "_" for each in known))


def commented(design: Design, mark: str, about: str, remarks: Iterable[str], lines: Iterable[str]) -> str:
    """Return lines for a machine below comments: whose ramp they are, how they are used, what is lost.

    mark: what begins a comment.
    """
    made = f"Made by StepRamp {__version__}; changes are best made there."
    paragraphs = [f"{design.name}. {made}" if design.name else made, about, *(f"- {remark}" for remark in remarks)]
    heading = [
        f"{mark} {line}"
        for paragraph in paragraphs
        for line in wrap(harmless(paragraph), WIDTH, subsequent_indent="  " if paragraph.startswith("- ") else "")
    ]
    return "\n".join((*heading, *lines, ""))


def axis_number(letter: AxisLetter, most: int, name: str) -> int:
    """Return an axis's number, from 0; Rejected when the machine has no such axis."""
    number = LETTERS.index(letter)
    if number >= most:
        raise Rejected([Rejection("axis_letter", letter, f"{', '.join(LETTERS[:most])} with {name}")])
    return number
