"""What a controller is set to, as designs: to start from a machine that is there."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from stepramp.design import Design
from stepramp.errors import Rejected, Rejection


@dataclass(frozen=True)
class ReadAxis:
    """One axis of a controller, as a design."""

    name: str
    """What the controller calls it."""
    design: Design
    remarks: tuple[str, ...]
    """What is not as the controller has it, as sentences."""


ReadSettings = Callable[[str, Design], list[ReadAxis]]
"""Makes a design of each axis that a text tells of; what it doesn't tell is that of another design.

[] for a text that no controller of the family tells. Raises Rejected for one that makes no sense."""


def design_read(document: dict[str, Any], whose: str) -> Design:
    """Return a design of what was read. whose: such as "axis X". Raises Rejected for what no design can have."""
    try:
        return Design.checked(document)
    except Rejected as error:
        raise Rejected(
            [
                Rejection("text", each.value, f"settings of {whose} that a design can have: {each.message.rstrip('.')}")
                for each in error.rejections
            ]
        ) from error
