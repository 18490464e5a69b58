"""Beginning a session: what the controller is and can do."""

from dataclasses import dataclass
from enum import IntEnum
from typing import ClassVar

from stepramp.controllers.stepramp.messages.axes import MOST_AXES
from stepramp.controllers.stepramp.messages.body import Reply, Request

PROTOCOL_VERSION = 2


class RampInUse(IntEnum):
    """Where the ramps come from that moves are played with."""

    NONE = 0
    STORED = 1
    ON_TRIAL = 2


@dataclass(frozen=True)
class HelloRequest(Request):
    """Begin a session."""

    KIND = 0x01
    LAYOUT = "<B"
    protocol_version: int = PROTOCOL_VERSION


@dataclass(frozen=True)
class HelloReply(Reply):
    """What the controller is, what it can do, and which ramp it has."""

    LAYOUT = "<4B 2I 4H 3H I HH 3B I H B"
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

    def __post_init__(self) -> None:
        if not self.fast_clock_hz or not self.slow_clock_hz or self.fast_clock_hz % self.slow_clock_hz:
            raise ValueError(f"Clocks of {self.fast_clock_hz} Hz and {self.slow_clock_hz} Hz.")
        if not 1 <= self.axes <= MOST_AXES:
            raise ValueError(f"{self.axes} axes.")
        intervals = self.longest_interval_ticks, self.shortest_formula_interval, *self.shortest_intervals[: self.axes]
        if not all(intervals):
            raise ValueError(f"Intervals of 0 ticks among {', '.join(map(str, intervals))}.")
        RampInUse(self.ramp_in_use)
