"""Axes as requests and settings name them, whatever the controller."""

from collections.abc import Sequence
from typing import Annotated

from pydantic import AfterValidator

from stepramp.controllers.contract import AxisCommand
from stepramp.errors import Refused, Rejected, Rejection
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


def refuse_ramp_axis(ramp_axis: int | None, called: str) -> None:
    """Reject an axis whose ramp is to be played along a line, by a controller that keeps to the limits of all."""
    if ramp_axis is not None:
        allowed = f"null: along a line {called} keeps to the limits of all axes, and plays no single one's ramp"
        raise Rejected([Rejection("ramp_axis", ramp_axis, allowed)])


def refuse_axes(asked: Sequence[AxisCommand], axes: int) -> None:
    """Reject axes that aren't there, and those that are named twice."""
    named = [each.axis for each in asked]
    for number, each in enumerate(asked):
        if each.axis >= axes or each.axis in named[:number]:
            beside = each.field.rpartition(".")[0] + ".axis" if "." in each.field else "axis"
            allowed = "each axis once" if each.axis < axes else f"an axis of this controller: 0 to {axes - 1}"
            raise Rejected([Rejection(each.field if each.field == "axes" else beside, each.axis, allowed)])


def refusal_of_moving(axis: int | None) -> Refused:
    """Return the refusal of what can't be done while a motor moves. axis: one that does, if known."""
    if axis is None:
        return Refused("The motor moves: stop it first.")
    return Refused(f"The motor moves, that of axis {axis}: stop it first.", "axis", axis, "at rest")
