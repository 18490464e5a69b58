"""Axes as requests and settings name them, whatever the controller."""

from typing import Annotated

from pydantic import AfterValidator

from stepramp.validation import ListOf, ListOrNull, Within

MOST_AXES = 4
"""So many axes a controller of any family has at most."""
MOST_NAMED = 4 * MOST_AXES
"""Longest list of axes; naming one twice is harmless."""


def _in_order(axes: tuple[int, ...] | None) -> tuple[int, ...] | None:
    return None if axes is None else tuple(sorted(set(axes)))


_AXES = f"axes, whole numbers from 0 to {MOST_AXES - 1}"
AxisNumber = Annotated[int, Within(0, MOST_AXES - 1)]
AxisNumbersAsGiven = Annotated[tuple[AxisNumber, ...], ListOf(_AXES, most=MOST_NAMED)]
AxisNumbers = Annotated[AxisNumbersAsGiven, AfterValidator(_in_order)]
AxisNumbersOrNull = Annotated[
    tuple[AxisNumber, ...] | None, ListOrNull(_AXES, most=MOST_NAMED), AfterValidator(_in_order)
]
