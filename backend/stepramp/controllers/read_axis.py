"""What a controller is set to, as designs: to start from a machine that is there."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from stepramp.controllers.remark import told_in
from stepramp.design import Design
from stepramp.errors import Count, Rejected, Rejection, Told, shown


@dataclass(frozen=True)
class ReadAxis:
    """One axis of a controller, as a design."""

    name: str
    """What the controller calls it."""
    design: Design
    remarks: tuple[str, ...]
    """What is not as the controller has it, as sentences."""

    @property
    def remarks_told(self) -> tuple[tuple[Told, ...], ...]:
        """The quantities of each remark that the design's axis converts."""
        return told_in(self.remarks)


ReadSettings = Callable[[str, Design], list[ReadAxis]]
"""Makes a design of each axis that a text tells of; what it doesn't tell is that of another design.

[] for a text that no controller of the family tells. Raises Rejected for one that makes no sense."""


def with_notes(axes: Iterable[ReadAxis], notes: Iterable[str]) -> list[ReadAxis]:
    """Return axes with remarks on the text as a whole: each of them has these, so that none is said of one axis."""
    told = tuple(notes)
    return [replace(axis, remarks=(*axis.remarks, *told)) for axis in axes]


FIGURES = {
    "axis.travel_per_rev": "the travel of a turn",
    "axis.full_steps_per_rev": "the number of full steps",
    "axis.microsteps": "the number of microsteps",
    "ramp.base_speed_steps_per_s": "the base speed",
    "ramp.slew_speed_steps_per_s": "the slew speed",
    "ramp.acceleration_steps_per_s2": "the acceleration",
    "ramp.deceleration_steps_per_s2": "the deceleration",
}
"""What people call the fields of a design that are read."""
SCALE, SPEED, GAIN = "axis.travel_per_rev", "ramp.slew_speed_steps_per_s", "ramp.acceleration_steps_per_s2"


def refused_setting(value: str, words: str, allowed: str) -> Rejection:
    """Return the rejection of a text for a setting in it. words: what is wrong, in the controller's own names."""
    return Rejection("text", value, allowed, reason=f"{shown(Count(words))}; allowed: {allowed}.")


def design_read(document: dict[str, Any], whose: str, settings: Mapping[str, str]) -> Design:
    """Return a design of what was read. Raises Rejected for what no design can have.

    whose: such as "axis X". settings: those that fields of it are made of, as people know them.
    """
    try:
        return Design.checked(document)
    except Rejected as error:
        raise Rejected([_of_setting(each, whose, settings.get(each.field)) for each in error.rejections]) from error


def _of_setting(found: Rejection, whose: str, setting: str | None) -> Rejection:
    why = found.message.rstrip(".")
    allowed = f"settings of {whose} that a design can have: {why}"
    if setting is None:
        return Rejection("text", found.value, allowed, reason=f"No design can be made of {whose}: {why}.")
    figure = f"{found.value:,.10g}" if isinstance(found.value, int | float) else shown(found.value)
    made = f"With {shown(Count(setting))} {FIGURES[found.field]} of {whose} is {figure}"
    return Rejection("text", found.value, allowed, reason=f"{made}; allowed: {found.allowed}.")
