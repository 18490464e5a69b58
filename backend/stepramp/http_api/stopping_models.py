"""What the routes that stop, and the messages that do, take and answer."""

import json
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from stepramp.controllers.axes import AxisNumbersOrNull
from stepramp.http_api.answer import Answer
from stepramp.http_api.devices_models import DeviceAnswer, DevicesAnswer
from stepramp.http_api.error_items import ErrorItem
from stepramp.http_api.motion_models import refuse_own_axes
from stepramp.validation import Document, Within, refuse

LONGEST_MESSAGE = 1000
"""Far more than any message needs [characters]."""


class AxesPayload(Document):
    """Which axes are to stop."""

    axes: AxisNumbersOrNull = Field(None, description="Which axes; null: all")

    @model_validator(mode="after")
    def _some(self) -> Self:
        if self.axes is not None:
            refuse_own_axes(self.axes, {})
        return self


class StopMessage(Document):
    """What the WebSocket of events is told."""

    do: Literal["stop", "halt"] = Field(description="stop: slow all devices down. halt: let one make no further step")
    device: str | None = Field(None, description="Which device halts")
    number: Annotated[int, Within(0, 2**53, note=" or null")] | None = Field(
        None, description="Is told again in the answer, to know which message it answers"
    )

    @model_validator(mode="after")
    def _one_halts(self) -> Self:
        if self.do == "halt" and self.device is None:
            refuse("device", None, "the id of the device that is to halt")
        if self.do == "stop" and self.device is not None:
            refuse("device", self.device, "nothing, since a stop over this WebSocket is for all devices")
        return self


class _Pairs(list[tuple[str, object]]):
    """All that an object gives, also what it gives more than once."""


def meant_by(text: str | bytes) -> StopMessage | None:
    """Return what a message that isn't right asks for all the same: no stop may fail for form's sake.

    All devices stop when it says stop, whatever else it says, or halt of none that it names. None: it says neither, or
    is longer than any that may be looked at.
    """
    if isinstance(text, bytes) or len(text) > LONGEST_MESSAGE:
        return None
    try:
        given = json.loads(text, object_pairs_hook=_Pairs)
    except (ValueError, RecursionError):
        return None
    if not isinstance(given, _Pairs):
        return None
    asked = [value for name, value in given if name == "do"]
    named = [value for name, value in given if name == "device"]
    if "stop" not in asked and "halt" in asked and len(named) == 1 and isinstance(named[0], str):
        return StopMessage(do="halt", device=named[0])
    return StopMessage(do="stop") if "stop" in asked or "halt" in asked else None


class StoppedAnswer(Answer):
    """A message that was understood, as it was understood."""

    do: Literal["stop", "halt"]
    device: str | None
    number: int | None = Field(description="That of the message; null: it had none")


class AllStoppedAnswer(DevicesAnswer):
    """All devices, which are stopped."""

    errors: list[ErrorItem] | None = Field(
        None, description="Of which devices a stop is owed, and why; left out where all are stopped"
    )


class StopMessageAnswer(Answer):
    """What a message to stop is answered."""

    did: StoppedAnswer | None = Field(None, description="What was asked for; left out when that was not understood")
    errors: list[ErrorItem] | None = Field(
        None,
        description="Why it wasn't done, of which devices a stop is owed, or what can't be used of the message; else "
        "left out",
    )
    devices: list[DeviceAnswer] | None = Field(None, description="All devices; left out when it wasn't done")
