"""What the WebSocket of a jog takes."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from stepramp.controllers.axes import AxisNumber
from stepramp.controllers.contract import AxisCommand
from stepramp.http_api.motion_models import AXIS, Speed
from stepramp.validation import Document, Within, refuse


class JogPayload(Document):
    """What the WebSocket of a jog is told."""

    do: Literal["run", "hold", "end"] = Field(
        description="run: begin, or change the speed. hold: go on. end: slow down"
    )
    axis: AxisNumber = Field(0, description=AXIS)
    speed_steps_per_s: Speed | None = Field(
        None, description="Speed to run at, negative for backwards; required to run [steps/s]"
    )
    stops: Annotated[int, Within(0, 2**53, note=" or null")] | None = Field(
        None, description="As the header X-StepRamp-Stops of other motions: browsers can give WebSockets no headers"
    )

    @model_validator(mode="after")
    def _runs_at_a_speed(self) -> Self:
        if self.do == "run" and self.speed_steps_per_s is None:
            refuse("speed_steps_per_s", None, "a speed in steps/s, since it is to run")
        return self

    @property
    def command(self) -> AxisCommand:
        """How fast the axis is to run, if it is."""
        return AxisCommand(self.axis, self.speed_steps_per_s or 0.0, "speed_steps_per_s")
