"""What is asked of a motor besides a design: the same limits in the same words over HTTP and from Python."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from stepramp.design import Acceleration
from stepramp.errors import Limits
from stepramp.motor.map_points import Over
from stepramp.motor.map_ranges import UNITS, VALUES
from stepramp.motor.stall_map import COARSE
from stepramp.motor.verdict import MOST_USED
from stepramp.validation import AnyNumber, Document, ListOf, Within, refuse

MOST_SPEEDS = 10_000
MOST_CELLS = 128

SomeRpm = Annotated[float, Within(0, 100_000, "rpm")]
Ends = Annotated[
    tuple[Annotated[float, AnyNumber()], Annotated[float, AnyNumber()]],
    ListOf("two numbers, the least and the most", length=2),
]
Accelerations = Annotated[
    tuple[Acceleration, Acceleration], ListOf("two numbers, the least and the most [steps/s²]", length=2)
]


class SpeedsAsked(Document):
    """Speeds at which torques are asked for."""

    speeds_rpm: Annotated[list[SomeRpm], ListOf("speeds [rpm]", most=MOST_SPEEDS, least=1)] = Field(
        description="Speeds of the motor's shaft [rpm]"
    )


class MarginAsked(Document):
    """How much of the motor's torque a ramp may ask for."""

    margin: Annotated[float, Within(0.05, 1, "of the motor's torque")] = Field(
        MOST_USED, description="m: at most so much of the pull-out torque is used; over 0.6 is marginal at best"
    )


class MapAsked(Document):
    """What a stall map varies, and from where to where."""

    over: Over = Field(
        "slew_speed",
        description="What is varied beside the acceleration: slew_speed and supply_voltage, drive.supply_v, in equal "
        "ratios; load, load.torque_nm, evenly",
    )
    range: Ends | None = Field(
        None, description="From where to where [steps/s, Nm or V]; null: around the design's own, as far as its border"
    )
    accelerations_steps_per_s2: Accelerations | None = Field(
        None, description="From where to where [steps/s²]; null: around the design's own, as far as its border"
    )
    cells: Annotated[int, Within(COARSE, MOST_CELLS, "cells", ", a power of two")] = Field(
        64, description="Along each side [cells]"
    )

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.range is not None:
            lowest, highest = VALUES[self.over]
            for number, end in enumerate(self.range):
                if not lowest <= end <= highest:
                    refuse(f"range.{number}", end, Limits(lowest, highest, UNITS[self.over]))
        for field in ("range", "accelerations_steps_per_s2"):
            ends = getattr(self, field)
            if ends is not None and ends[0] >= ends[1]:
                refuse(f"{field}.1", ends[1], f"more than {ends[0]:,.15g}, the least")
        return self

    @model_validator(mode="after")
    def _power_of_two(self) -> Self:
        if self.cells & (self.cells - 1):
            refuse("cells", self.cells, "8, 16, 32, 64 or 128")
        return self
