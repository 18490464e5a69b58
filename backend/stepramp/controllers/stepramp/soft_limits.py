"""Soft limits that a StepRamp controller keeps itself: how far its axes may go while their positions are known."""

import struct
from collections.abc import Iterable
from typing import Annotated, Self

from pydantic import AfterValidator, Field, model_validator

from stepramp.controllers.axes import MOST_AXES, AxisNumber
from stepramp.validation import Document, ListOrNull, Within, refuse

LOWEST, HIGHEST = -(2**31), 2**31 - 1
"""Where positions end: there is no limit there."""
AT_LOWEST, AT_HIGHEST = 0xFE, 0xFF
"""In place of an input's number, of a refusal: the limit that is in the way."""
_BYTES = struct.Struct("<ii")
NO_LIMITS = _BYTES.pack(LOWEST, HIGHEST) * MOST_AXES
"""Of all axes, as they are stored."""

Position = Annotated[int, Within(LOWEST, HIGHEST, "steps", ", or null: no limit on that side")]


class SoftLimit(Document):
    """How far one axis may go."""

    axis: AxisNumber = Field(description="Which, from 0")
    lowest_steps: Position | None = Field(None, description="Lowest position; null: no limit on that side [steps]")
    highest_steps: Position | None = Field(None, description="Highest position; null: no limit on that side [steps]")

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        lowest, highest = self.bounds
        if lowest > highest:
            refuse("lowest_steps", lowest, f"at most highest_steps, which is {highest:,}")
        return self

    @property
    def bounds(self) -> tuple[int, int]:
        """The lowest and the highest position; where there is no limit, where positions end [steps]."""
        lowest = LOWEST if self.lowest_steps is None else self.lowest_steps
        return lowest, HIGHEST if self.highest_steps is None else self.highest_steps


def _each_once(limits: tuple[SoftLimit, ...] | None) -> tuple[SoftLimit, ...] | None:
    if limits is None:
        return None
    named = [limit.axis for limit in limits]
    for number, axis in enumerate(named):
        if axis in named[:number]:
            refuse(f"{number}.axis", axis, "each axis once")
    return tuple(sorted((each for each in limits if each.bounds != (LOWEST, HIGHEST)), key=lambda each: each.axis))


SoftLimits = Annotated[
    tuple[SoftLimit, ...] | None, ListOrNull("axes and how far they may go", most=MOST_AXES), AfterValidator(_each_once)
]


def packed_limits(limits: Iterable[SoftLimit]) -> bytes:
    """Return the limits of all axes as they are stored."""
    by_axis = {limit.axis: limit.bounds for limit in limits}
    return b"".join(_BYTES.pack(*by_axis.get(axis, (LOWEST, HIGHEST))) for axis in range(MOST_AXES))


def unpacked_limits(packed: bytes) -> tuple[SoftLimit, ...]:
    """Return stored limits; axes that have none are left out."""
    limits = (
        SoftLimit(
            axis=axis,
            lowest_steps=None if lowest == LOWEST else lowest,
            highest_steps=None if highest == HIGHEST else highest,
        )
        for axis, (lowest, highest) in enumerate(_BYTES.iter_unpack(packed))
    )
    return tuple(limit for limit in limits if limit.bounds != (LOWEST, HIGHEST))


def bounds_of(packed: bytes, axis: int) -> tuple[int, int]:
    """Return an axis' lowest and highest position of stored limits [steps]."""
    lowest, highest = _BYTES.unpack_from(packed, axis * _BYTES.size)
    return lowest, highest
