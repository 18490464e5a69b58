"""Axes in messages: as bits of a mask, and one value for each."""

from collections.abc import Iterable
from dataclasses import dataclass

from stepramp.controllers.stepramp.messages.body import Request

MOST_AXES = 4
ALL_AXES = (1 << MOST_AXES) - 1


def mask_of(axes: Iterable[int]) -> int:
    """Return axes as bits, axis 0 the lowest."""
    return sum(1 << axis for axis in set(axes))


def axes_of(mask: int) -> list[int]:
    """Return the axes whose bits are set, in ascending order."""
    return [axis for axis in range(mask.bit_length()) if mask >> axis & 1]


@dataclass(frozen=True)
class AxesRequest(Request):
    """A request with one value for each axis of a mask, in ascending order."""

    LAYOUT = "<B"
    TAIL = range(9)
    EACH = "i"
    axes: int
    values: tuple[int, ...]

    def __post_init__(self) -> None:
        if self.axes.bit_count() != len(self.values):
            raise ValueError(f"{len(self.values)} values for {self.axes.bit_count()} axes.")

    @property
    def by_axis(self) -> dict[int, int]:
        """The values by their axes."""
        return dict(zip(axes_of(self.axes), self.values, strict=True))
