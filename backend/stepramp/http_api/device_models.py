"""What the device routes take and answer."""

from typing import Annotated, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from stepramp.controllers.device import DeviceState
from stepramp.design import Design
from stepramp.validation import Document, Text, Within, refuse

Steps = Annotated[int, Within(-(2**31), 2**31 - 1, "steps")]


class ConnectRequest(Document):
    """A port to connect to."""

    port: Annotated[str, Text(200)] = Field(
        description="Name of a serial port, or an address: sim://, socket://…, rfc2217://…"
    )


class PushRequest(Document):
    """A design whose ramp is to be stored in the controller."""

    design: Design


class MoveRequest(Document):
    """Where to move: one of the two."""

    by_steps: Steps | None = Field(None, description="How far from here, negative for backwards [steps]")
    to_steps: Steps | None = Field(None, description="Which position to move to [steps]")

    @model_validator(mode="after")
    def _one_of_two(self) -> Self:
        if self.by_steps is not None and self.to_steps is not None:
            refuse("to_steps", self.to_steps, "nothing, since by_steps is given")
        if self.by_steps is None and self.to_steps is None:
            refuse("by_steps", None, "a whole number of steps, or else to_steps")
        if self.by_steps == 0:
            refuse("by_steps", 0, "a whole number of steps, but not 0")
        return self


class Answer(BaseModel):
    """Base of the answers: filled from objects with the same fields."""

    model_config = ConfigDict(from_attributes=True)


class PortAnswer(Answer):
    """A port that can be connected to."""

    port: str = Field(description="What to connect to")
    name: str = Field(description="What people call it")
    virtual: bool = Field(description="Whether nothing is attached: the virtual controller")


class PortsAnswer(Answer):
    """The ports of this machine, the virtual one last."""

    ports: list[PortAnswer]


class RampAnswer(Answer):
    """The ramp that a controller has."""

    sequence: int = Field(description="How many ramps were stored so far, this one included")
    crc: int = Field(description="CRC-16 of its image")


class PushItemAnswer(Answer):
    """One figure on its way from the design to the controller, as text."""

    name: str = Field(description="What it is")
    unit: str = Field(description="Unit of the figures: µs, steps, or none")
    requested: str = Field(description="What the design asks for")
    sent: str = Field(description="What was sent")
    read_back: str = Field(description="What the controller stored")


class PushAnswer(Answer):
    """What came of a push."""

    items: list[PushItemAnswer]
    verified: bool = Field(description="Whether what was read back is what was sent, byte for byte")
    segments: int = Field(description="Segments sent")
    bytes: int = Field(description="Length of what the controller stored [bytes]")
    largest_deviation_us: float = Field(
        description="Largest difference between an interval of the design's ramp and the controller's [µs]"
    )
    sequence: int = Field(description="How many ramps the controller has stored so far, this one included")
    warnings: list[str] = Field(description="What works, but not as the design says")


class DeviceAnswer(Answer):
    """A device as it is now."""

    id: str = Field(description="What the routes call it")
    port: str = Field(description="Where it is")
    name: str = Field(description="What people call it")
    state: DeviceState = Field(description="lost: no longer there; connect to its port again")
    message: str | None = Field(description="Why it is lost")
    position_steps: int = Field(description="Where the motor is [steps]")
    target_steps: int = Field(description="Where it will come to rest [steps]")
    speed_steps_per_s: float = Field(description="How fast it moves, without sign [steps/s]")
    timer_hz: int | None = Field(description="Ticks a second of its step timer [Hz]; null until it is connected")
    firmware_version: str | None = Field(description="Version of its firmware; null until it is connected")
    ramp: RampAnswer | None = Field(description="The ramp it has; null for none")
    pushed: PushAnswer | None = Field(description="The last push over this connection; null for none")


class DevicesAnswer(Answer):
    """All devices."""

    devices: list[DeviceAnswer]


class DisconnectedAnswer(Answer):
    """Nothing: the device is gone."""
