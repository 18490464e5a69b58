"""What the WebSocket of a jog takes."""

from typing import Annotated, Literal

from pydantic import Field

from stepramp.controllers.axes import AxisNumber
from stepramp.controllers.contract import AxisCommand
from stepramp.http_api.motion_models import AXIS, Speed
from stepramp.validation import Document, Within


class JogPayload(Document):
    """What the WebSocket of a jog is told."""

    do: Literal["run", "hold", "end"] = Field(
        description="run: begin, or change the speed. hold: go on. end: slow down"
    )
    axis: AxisNumber = Field(0, description=AXIS)
    speed_steps_per_s: Speed = Field(0.0, description="Speed to run at, negative for backwards [steps/s]")
    stops: Annotated[int, Within(0, 2**53, note=" or null")] | None = Field(
        None, description="As the header X-StepRamp-Stops of other motions: browsers can give WebSockets no headers"
    )

    @property
    def command(self) -> AxisCommand:
        """How fast the axis is to run."""
        return AxisCommand(self.axis, self.speed_steps_per_s, "speed_steps_per_s")
