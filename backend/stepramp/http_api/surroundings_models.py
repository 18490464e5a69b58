"""What the routes over the surroundings of a virtual controller take and answer."""

from typing import Annotated, Self

from pydantic import Field, StrictBool, model_validator

from stepramp.controllers.axes import MOST_AXES, AxisNumber
from stepramp.controllers.surroundings import SurroundingsChange, Switches
from stepramp.errors import Limits
from stepramp.http_api.answer import Answer
from stepramp.http_api.motion_models import AXIS, Steps
from stepramp.validation import Document, ListOrNull, refuse


class AxisSwitches(Document):
    """Where the limit switches of one axis are."""

    axis: AxisNumber = Field(description=AXIS)
    low_steps: Steps | None = Field(None, description="Place from which on the low one is active; null: none [steps]")
    high_steps: Steps | None = Field(None, description="Place from which on the high one is; null: none [steps]")

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.low_steps is not None and self.high_steps is not None and self.high_steps <= self.low_steps:
            limits = Limits(lowest=self.low_steps + 1, unit="steps", is_whole=True, note=", beyond the low one")
            refuse("high_steps", self.high_steps, limits)
        return self


class SurroundingsPayload(Document):
    """What is to change around a virtual controller; what isn't given, or null, stays as it is.

    An axis that is named has both of its switches anew: one that isn't given, or null, is taken away.
    """

    emergency_stop: StrictBool | None = Field(None, description="Whether the emergency stop is pressed")
    driver_fault: StrictBool | None = Field(None, description="Whether a driver has a fault")
    axes: Annotated[list[AxisSwitches] | None, ListOrNull("axes and their switches", most=MOST_AXES, least=1)] = Field(
        None, description="Axes whose switches are put elsewhere, each once; those of others stay. null: of all"
    )

    @model_validator(mode="after")
    def _each_once(self) -> Self:
        axes = [each.axis for each in self.axes or ()]
        for number, axis in enumerate(axes):
            if axis in axes[:number]:
                refuse(f"axes.{number}.axis", axis, "each axis once")
        return self

    @property
    def change(self) -> SurroundingsChange:
        """What is to change."""
        switches = {each.axis: Switches(each.low_steps, each.high_steps) for each in self.axes or ()}
        return SurroundingsChange(self.emergency_stop, self.driver_fault, switches)


class AxisSurroundingsAnswer(Answer):
    """An axis in the world around a virtual controller."""

    axis: int = Field(description="Which axis, from 0")
    place_steps: int = Field(
        description="Where it is, counted from where it was when the program started, whatever its position is called "
        "[steps]"
    )
    low_steps: int | None = Field(description="Place from which on its low switch is active; null for none [steps]")
    high_steps: int | None = Field(description="Place from which on its high one is; null for none [steps]")


class SurroundingsAnswer(Answer):
    """What is around a virtual controller."""

    emergency_stop: bool = Field(description="Whether the emergency stop is pressed")
    driver_fault: bool = Field(description="Whether a driver has a fault")
    axes: list[AxisSurroundingsAnswer] = Field(description="All axes that there may be")
