"""Beginning a session: what the controller is and can do."""

from dataclasses import dataclass
from enum import IntEnum, IntFlag
from typing import ClassVar

from stepramp.controllers.stepramp.messages.axes import MOST_AXES
from stepramp.controllers.stepramp.messages.body import Reply, Request

PROTOCOL_VERSION = 3
OLDEST_VERSION = 2
"""Spoken with a controller that doesn't speak the newest."""


_MORE_BYTES = 3


class RampInUse(IntEnum):
    """Where the ramps come from that moves are played with."""

    NONE = 0
    STORED = 1
    ON_TRIAL = 2


class Ability(IntFlag):
    """What a controller can do, from version 3 on; bits that aren't named mean nothing."""

    FORMULAS = 1
    GAUGES = 2
    INPUTS = 4
    KEEPS = 8
    SOFT_LIMITS = 16


@dataclass(frozen=True)
class HelloRequest(Request):
    """Begin a session."""

    KIND = 0x01
    LAYOUT = "<B"
    protocol_version: int = PROTOCOL_VERSION


@dataclass(frozen=True)
class HelloReply(Reply):
    """What the controller is, what it can do, and which ramp it has. One of version 2 says nothing more."""

    LAYOUT = "<4B 2I 4H 3H I HH 3B I H B"
    TAIL = range(8)
    TUPLES: ClassVar[dict[str, int]] = {"shortest_intervals": MOST_AXES, "shortest_line_intervals": MOST_AXES - 1}
    protocol_version: int
    firmware_major: int
    firmware_minor: int
    firmware_patch: int
    fast_clock_hz: int
    slow_clock_hz: int
    shortest_intervals: tuple[int, ...]
    """When 1, 2, 3, 4 axes move at the same time [fast ticks]."""
    shortest_line_intervals: tuple[int, ...]
    """Of the leader of a line of 2, 3, 4 axes [fast ticks]."""
    longest_interval_ticks: int
    shortest_formula_interval: int
    """Of a ramp that is computed while it is played [fast ticks]."""
    largest_image_bytes: int
    most_segments: int
    """Of one ramp, up and down together."""
    axes: int
    reset_cause: int
    """Bits: power, external, brown-out, watchdog."""
    ramp_sequence: int
    image_crc: int
    ramp_in_use: int
    more: bytes = b""
    """From version 3 on: what it can do, how long its settings are and its status, and what later versions may add."""

    @property
    def has_inputs(self) -> bool:
        """Whether it has inputs, and all that goes with them."""
        return bool(self.more) and bool(self.more[0] & Ability.INPUTS)

    @property
    def has_soft_limits(self) -> bool:
        """Whether it keeps axes within soft limits of its own."""
        return bool(self.more) and bool(self.more[0] & Ability.SOFT_LIMITS)

    @property
    def computes_formulas(self) -> bool:
        """Whether it plays ramps that it computes itself: one of version 2 doesn't say that it doesn't."""
        return not self.more or bool(self.more[0] & Ability.FORMULAS)

    def __post_init__(self) -> None:
        if not self.fast_clock_hz or not self.slow_clock_hz or self.fast_clock_hz % self.slow_clock_hz:
            raise ValueError(f"Clocks of {self.fast_clock_hz} Hz and {self.slow_clock_hz} Hz.")
        if not 1 <= self.axes <= MOST_AXES:
            raise ValueError(f"{self.axes} axes.")
        intervals = self.longest_interval_ticks, self.shortest_formula_interval, *self.shortest_intervals[: self.axes]
        if not all(intervals):
            raise ValueError(f"Intervals of 0 ticks among {', '.join(map(str, intervals))}.")
        RampInUse(self.ramp_in_use)
        if self.protocol_version > OLDEST_VERSION and len(self.more) < _MORE_BYTES:
            raise ValueError(f"A hello of version {self.protocol_version} with {len(self.more)} bytes of its own.")
