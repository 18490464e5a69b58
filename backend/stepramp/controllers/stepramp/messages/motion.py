"""Moving and stopping axes."""

from dataclasses import dataclass

from stepramp.controllers.stepramp.messages.axes import MOST_AXES, AxesRequest, axes_of
from stepramp.controllers.stepramp.messages.body import Reply, Request


@dataclass(frozen=True)
class TargetsReply(Reply):
    """Where each axis that was asked will come to rest [steps]."""

    TAIL = range(MOST_AXES + 1)
    EACH = "i"
    targets_steps: tuple[int, ...]


@dataclass(frozen=True)
class MoveByRequest(AxesRequest):
    """Move axes by so many steps from where they would come to rest."""

    KIND = 0x20
    HARMLESS_TWICE = False


@dataclass(frozen=True)
class MoveToRequest(AxesRequest):
    """Move axes to positions [steps]."""

    KIND = 0x21


@dataclass(frozen=True)
class RunRequest(AxesRequest):
    """Run axes at intervals [ticks], negative for backwards; 0: stop."""

    KIND = 0x22


@dataclass(frozen=True)
class LineRequest(Request):
    """Move axes by so many steps along a straight line; the one with most steps plays the ramp of an axis."""

    KIND = 0x23
    HARMLESS_TWICE = False
    LAYOUT = "<BB"
    TAIL = range(9)
    EACH = "i"
    axes: int
    ramp_axis: int
    steps: tuple[int, ...]

    def __post_init__(self) -> None:
        if self.axes.bit_count() != len(self.steps):
            raise ValueError(f"{len(self.steps)} values for {self.axes.bit_count()} axes.")

    @property
    def by_axis(self) -> dict[int, int]:
        """The steps by their axes."""
        return dict(zip(axes_of(self.axes), self.steps, strict=True))


@dataclass(frozen=True)
class SetPositionRequest(AxesRequest):
    """Call the places where axes are these positions [steps]."""

    KIND = 0x24


@dataclass(frozen=True)
class ZeroRequest(Request):
    """Call the places where axes are so many steps, and move them to 0."""

    KIND = 0x25
    HARMLESS_TWICE = False
    LAYOUT = "<BH"
    axes: int
    steps: int


@dataclass(frozen=True)
class AcknowledgeRequest(Request):
    """Take motions again after an emergency stop or a driver's fault."""

    KIND = 0x26
    # A repeat that is a new one might acknowledge what has stopped motion since.
    HARMLESS_TWICE = False


@dataclass(frozen=True)
class HomeRequest(Request):
    """Find axes' limit switches: at these intervals towards them [ticks], negative for backwards."""

    KIND = 0x27
    HARMLESS_TWICE = False
    LAYOUT = "<BIH"
    TAIL = range(9)
    EACH = "i"
    axes: int
    slow_interval_ticks: int
    back_off_steps: int
    fast_intervals_ticks: tuple[int, ...]

    def __post_init__(self) -> None:
        if self.axes.bit_count() != len(self.fast_intervals_ticks):
            raise ValueError(f"{len(self.fast_intervals_ticks)} values for {self.axes.bit_count()} axes.")

    @property
    def by_axis(self) -> dict[int, int]:
        """The intervals of the fast approach by their axes."""
        return dict(zip(axes_of(self.axes), self.fast_intervals_ticks, strict=True))


@dataclass(frozen=True)
class StopRequest(Request):
    """Slow down with the ramp: all axes, or those of a mask."""

    KIND = 0x30
    TAIL = range(2)
    axes: bytes = b""
    """Nothing, or one byte."""


@dataclass(frozen=True)
class HaltRequest(Request):
    """Make no further step: all axes, or those of a mask."""

    KIND = 0x31
    TAIL = range(2)
    axes: bytes = b""
    """Nothing, or one byte."""
