"""What the route of the motors' presets answers."""

from typing import Self

from pydantic import Field

from stepramp.design import AxisScale
from stepramp.drive_train import Drive, Load, Motor
from stepramp.http_api.answer import Answer
from stepramp.motor.presets import PRESETS, Source


class MotorPresetAnswer(Answer):
    """A motor, and what people are told of it."""

    name: str
    help: str = Field(description="What it is, and what of its figures is assumed")
    motor: Motor
    drive: Drive | None = Field(description="Null: its maker fixes nothing of it")
    load: Load | None = Field(description="Null: its maker fixes nothing of it")
    axis: AxisScale | None = Field(description="What one turn of it is; null: 200 full steps")
    sources: dict[str, Source] = Field(description="Where each field of motor, drive and load comes from, by its path")


class MotorPresetsAnswer(Answer):
    """The motors, in the order in which people are shown them."""

    presets: list[MotorPresetAnswer]

    @classmethod
    def of_all(cls) -> Self:
        """Return what is told of the motors that there are."""
        return cls(presets=[MotorPresetAnswer.model_validate(each) for each in PRESETS])
