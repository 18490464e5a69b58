"""Traces: when steps were made."""

from dataclasses import dataclass

from stepramp.controllers.stepramp.messages.body import Notice, Reply, Request

MOST_TRACE_VALUES = 12
TRACE_OFF = 255
TRACE_LAST = 0x80
"""Added to the axis in the last trace frame of a move."""


@dataclass(frozen=True)
class TraceRequest(Request):
    """Ask for the instants of every k-th step of each move of an axis that begins from now on."""

    KIND = 0x04
    LAYOUT = "<BH"
    axis: int
    """TRACE_OFF: no more of them."""
    every_steps: int
    """k; 0: the controller chooses."""


@dataclass(frozen=True)
class TraceReply(Reply):
    """Which steps will be traced."""

    LAYOUT = "<H"
    every_steps: int


@dataclass(frozen=True)
class TraceNotice(Notice):
    """The timer's values at every k-th step of a move."""

    KIND = 0xC1
    LAYOUT = "<BHI"
    TAIL = range(MOST_TRACE_VALUES + 1)
    EACH = "H"
    axis_and_last: int
    every_steps: int
    first_step: int
    values: tuple[int, ...]

    @property
    def axis(self) -> int:
        """The axis that is traced."""
        return self.axis_and_last & ~TRACE_LAST

    @property
    def is_last(self) -> bool:
        """Whether it is the last frame of this move."""
        return bool(self.axis_and_last & TRACE_LAST)
