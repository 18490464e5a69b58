"""Everything StepRamp raises on purpose.

StepRampError
├── Rejected            values from outside that can't be used; carries one Rejection a value
├── NotFound            no such device, port or page
├── Refused             understood, but not now (a device that moves takes no ramp)
├── Forbidden           a request from a page or a host that isn't ours
└── DeviceLost          the device doesn't answer, or its port is gone
"""

from collections.abc import Sequence
from dataclasses import dataclass


class StepRampError(Exception):
    """The root of the tree; its text is one sentence for people."""


@dataclass(frozen=True)
class Rejection:
    """One value that can't be used: which field, what it was, and what is allowed."""

    field: str
    value: object
    allowed: str

    @property
    def message(self) -> str:
        """The rejection as one sentence."""
        return f"{self.field} is {shown(self.value)}; allowed: {self.allowed}."


class Rejected(StepRampError, ValueError):
    """One or more values can't be used; nothing was done."""

    def __init__(self, rejections: Sequence[Rejection]) -> None:
        self.rejections = tuple(rejections)
        super().__init__("\n".join(rejection.message for rejection in self.rejections))


class NotFound(StepRampError, LookupError):
    """What was asked for does not exist."""


class Refused(StepRampError):
    """The request is sound, but can't be done in the present state."""


class Forbidden(StepRampError):
    """The request comes from a page or a host that may not control this server."""


class DeviceLost(StepRampError):
    """The device doesn't answer, or its port is gone."""


def shown(value: object) -> str:
    """Return a value as it stands in a message: short, on one line."""
    text = "missing" if value is None else repr(value) if isinstance(value, str) else str(value)
    text = " ".join(text.split())
    return text if len(text) <= 80 else text[:77] + "…"
