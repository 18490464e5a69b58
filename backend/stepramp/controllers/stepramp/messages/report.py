"""Reports: where all axes are, told unasked."""

from dataclasses import dataclass

from stepramp.controllers.stepramp.messages.axes import MOST_AXES
from stepramp.controllers.stepramp.messages.body import Notice, Request
from stepramp.controllers.stepramp.messages.status import AxisState

MOST_REPORTS_HZ = 50


@dataclass(frozen=True)
class ReportRequest(Request):
    """Ask for reports, so many times a second; 0: no more of them."""

    KIND = 0x03
    LAYOUT = "<B"
    rate_hz: int


@dataclass(frozen=True)
class ReportNotice(Notice):
    """Where all axes of the ramp image are."""

    KIND = 0xC0
    LAYOUT = "<HB"
    TAIL = range(MOST_AXES + 1)
    EACH = "iI"
    time_ms: int
    states: int
    """Two bits an axis, axis 0 the lowest."""
    axes: tuple[tuple[int, int], ...]
    """Position [steps] and interval [ticks; 0 at rest] of each."""

    def __post_init__(self) -> None:
        for axis in range(len(self.axes)):
            self.state_of(axis)

    def state_of(self, axis: int) -> AxisState:
        """Return what an axis is doing."""
        return AxisState(self.states >> 2 * axis & 3)
