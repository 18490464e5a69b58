"""What the route for reports takes."""

from itertools import pairwise
from typing import Annotated, Self

from pydantic import Field, model_validator

from stepramp.design import MOST_NAMES, Design, MethodName
from stepramp.errors import Count, Limits
from stepramp.exports.printed.content import Asked
from stepramp.exports.printed.stall_maps import UNKNOWN, VERDICTS, PlayedMap
from stepramp.motor.asked import MOST_CELLS
from stepramp.motor.map_points import Over
from stepramp.motor.map_ranges import ACCELERATIONS, UNITS, VALUES
from stepramp.units import LengthUnit, TimeUnit
from stepramp.validation import AnyNumber, Document, ListOf, Within, refuse


class UnitsPayload(Document):
    """The units that lengths, speeds and accelerations are shown in."""

    length: LengthUnit = Field("steps", description="mm only for designs whose travel is in mm")
    time: TimeUnit = Field("s", description="Unit of time of speeds and accelerations")


SomeAcceleration = Annotated[float, Within(*ACCELERATIONS, "steps/s²")]
MEANING = "-1 not known, 0 safe, 1 marginal, 2 stalls, 3 not possible"
SomeVerdict = Annotated[int, Within(UNKNOWN, len(VERDICTS) - 1, note=f": {MEANING}")]
MOST_POINTS = MOST_CELLS + 1


class StallMapPayload(Document):
    """A stall map of the design, as a job of `POST /motor/map` has answered it. Lists of n = cells + 1."""

    over: Over
    over_values: Annotated[
        list[Annotated[float, AnyNumber()]], ListOf("numbers, increasing", most=MOST_POINTS, least=2)
    ] = Field(description="One a column, increasing, shape (n,)")
    accelerations_steps_per_s2: Annotated[
        list[SomeAcceleration], ListOf("accelerations, increasing [steps/s²]", most=MOST_POINTS, least=2)
    ] = Field(description="One a row, increasing, shape (n,)")
    verdicts: Annotated[
        list[Annotated[list[SomeVerdict], ListOf("verdicts", most=MOST_POINTS)]], ListOf("rows", most=MOST_POINTS)
    ] = Field(description=f"{MEANING}; shape (n, n)")

    @model_validator(mode="after")
    def _fits_together(self) -> Self:
        lowest, highest = VALUES[self.over]
        for number, value in enumerate(self.over_values):
            if not lowest <= value <= highest:
                refuse(f"over_values.{number}", value, Limits(lowest, highest, UNITS[self.over]))
        for field in ("over_values", "accelerations_steps_per_s2"):
            values = getattr(self, field)
            for number, (before, value) in enumerate(pairwise(values), start=1):
                if value <= before:
                    refuse(f"{field}.{number}", value, f"more than {before:,.15g}, the one before")
        rows, columns = len(self.accelerations_steps_per_s2), len(self.over_values)
        if len(self.verdicts) != rows:
            refuse("verdicts", Count(f"{len(self.verdicts):,} rows"), f"{rows:,} rows, one for each acceleration")
        for number, row in enumerate(self.verdicts):
            if len(row) != columns:
                refuse(
                    f"verdicts.{number}", Count(f"{len(row):,} verdicts"), f"{columns:,} verdicts, one for each column"
                )
        return self

    @property
    def played(self) -> PlayedMap:
        """The map as a report takes it."""
        return PlayedMap(
            self.over,
            tuple(self.over_values),
            tuple(self.accelerations_steps_per_s2),
            tuple(tuple(row) for row in self.verdicts),
        )


class ReportPayload(Document):
    """A design, and what its report is to say besides."""

    design: Design
    pinned: Design | None = Field(None, description="A design that it is compared with, by its own method")
    methods: Annotated[list[MethodName], ListOf("method names", most=MOST_NAMES)] = Field(
        default=[], description="Methods that the design's own is compared with"
    )
    units: UnitsPayload = UnitsPayload()
    maps: Annotated[list[StallMapPayload], ListOf("stall maps", most=len(VALUES))] = Field(
        default=[], description="Stall maps of the design that were computed before; it needs a motor"
    )

    @model_validator(mode="after")
    def _maps_of_a_motor(self) -> Self:
        if self.maps and self.design.motor is None:
            refuse("maps", Count(f"{len(self.maps)} stall maps"), "none, since the design has no motor")
        return self

    @property
    def asked(self) -> Asked:
        """What the report is asked to be about."""
        maps = tuple(each.played for each in self.maps)
        return Asked(self.design, self.pinned, tuple(self.methods), self.units.length, self.units.time, maps)
