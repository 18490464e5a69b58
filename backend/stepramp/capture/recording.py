"""Recordings: the edges of some channels, whatever file they come from."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from stepramp.errors import Rejected, Rejection
from stepramp.numerics.compiled import compiled

FormatName = Literal["saleae_csv", "sigrok_csv", "vcd", "sigrok_session"]

MOST_CHANNELS = 64
MOST_EDGES = 25_000_000
"""Edges of all channels together: what fits in memory next to the file."""
UNKNOWN = -1
"""A level that is not known."""
LATEST_TICKS = 10**18
"""Instants are no further from zero, so that their differences fit in 64 bits; of picoseconds 1,000,000 s [ticks]."""

_EDGES_AT_A_TIME = 2**20


@dataclass(frozen=True)
class Recording:
    """What was captured. An edge is a change from one known level to the other."""

    format: FormatName
    channels: tuple[str, ...]
    """Their names, each another."""
    first_levels: NDArray[np.int8]
    """The first known level of each channel, or UNKNOWN, shape (channels,)."""
    edge_ticks: NDArray[np.int64]
    """Instant of each edge, not decreasing [ticks], shape (edges,)."""
    edge_codes: NDArray[np.uint8]
    """Of each edge twice the number of its channel, plus the level that it leads to, shape (edges,)."""
    begin_ticks: int
    end_ticks: int
    tick_s: Fraction
    """Length of a tick [s]."""
    sample_rate_hz: Fraction | None = None
    """How often the analyser looked, where the file says so [Hz]."""
    remarks: tuple[str, ...] = ()
    """What is odd about the file, as sentences."""

    def edges_of(self) -> NDArray[np.int64]:
        """Return how many edges each channel has, shape (channels,)."""
        counts = np.zeros(len(self.channels), np.int64)
        _count(self.edge_codes, counts)
        return counts


class EdgeList:
    """Room for edges that are found bit by bit: compiled loops fill it until it is full, and go on when it is empty."""

    def __init__(self) -> None:
        self.ticks = np.empty(_EDGES_AT_A_TIME, np.int64)
        self.codes = np.empty(_EDGES_AT_A_TIME, np.uint8)
        self._found: list[tuple[NDArray[np.int64], NDArray[np.uint8]]] = []
        self._count = 0

    def fill(self, more: Callable[[], int]) -> None:
        """Call `more`, which puts edges into `ticks` and `codes` and returns how many, until there are none left.

        Raises Rejected for more than MOST_EDGES.
        """
        while count := more():
            self._found.append((self.ticks[:count].copy(), self.codes[:count].copy()))
            self._count += count
            if self._count > MOST_EDGES:
                allowed = f"up to {MOST_EDGES:,} edges of all channels together: capture fewer channels, or less time"
                raise refused_file(f"a capture of more than {MOST_EDGES:,} edges", allowed)

    def all_ticks(self) -> NDArray[np.int64]:
        """Return the instants of all edges [ticks], shape (edges,)."""
        return np.concatenate([np.empty(0, np.int64), *(ticks for ticks, _ in self._found)])

    def all_codes(self) -> NDArray[np.uint8]:
        """Return the codes of all edges, shape (edges,)."""
        return np.concatenate([np.empty(0, np.uint8), *(codes for _, codes in self._found)])


@compiled
def _count(codes, counts):  # type: ignore[no-untyped-def]  # compiled
    for code in codes:
        counts[code >> 1] += 1


def refused_file(what: str, allowed: str) -> Rejected:
    """Return the rejection of a file: what it is, and what is allowed."""
    return Rejected([Rejection("file", what, allowed, reason=f"The file is {what}; allowed: {allowed}.")])


def refused_line(number: int, what: str, allowed: str) -> Rejected:
    """Return the rejection of a file for one of its lines, counted from 1: what that has, and what is allowed there."""
    reason = f"Line {number:,} of the file has {what}; allowed: {allowed}."
    return Rejected([Rejection("file", f"line {number:,}: {what}", allowed, reason=reason)])


def distinct(names: Sequence[str]) -> tuple[str, ...]:
    """Return names of channels, a number behind those that were there before or are empty."""
    given: list[str] = []
    for number, name in enumerate(names):
        wanted = candidate = name.strip() or f"Channel {number}"
        again = 2
        while candidate in given:
            candidate = f"{wanted} ({again})"
            again += 1
        given.append(candidate)
    return tuple(given)


def unknown_remark(count: int) -> tuple[str, ...]:
    """Return what is to be said of levels that are neither 0 nor 1."""
    if not count:
        return ()
    levels = "1 level is" if count == 1 else f"{count:,} levels are"
    return (f"{levels} neither 0 nor 1: there the level before is taken to last.",)


CUT = "The file ends in the midst of a line, which is left out: it may have been cut off."
"""What is to be said of a file that was cut off."""
