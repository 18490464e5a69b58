"""What the route for reports takes."""

from typing import Annotated

from pydantic import Field

from stepramp.design import MOST_NAMES, Design, MethodName
from stepramp.exports.printed.content import Asked
from stepramp.units import LengthUnit, TimeUnit
from stepramp.validation import Document, ListOf


class UnitsPayload(Document):
    """The units that lengths, speeds and accelerations are shown in."""

    length: LengthUnit = Field("steps", description="mm only for designs whose travel is in mm")
    time: TimeUnit = Field("s", description="Unit of time of speeds and accelerations")


class ReportPayload(Document):
    """A design, and what its report is to say besides."""

    design: Design
    pinned: Design | None = Field(None, description="A design that it is compared with, by its own method")
    methods: Annotated[list[MethodName], ListOf("method names", most=MOST_NAMES)] = Field(
        default=[], description="Methods that the design's own is compared with"
    )
    units: UnitsPayload = UnitsPayload()

    @property
    def asked(self) -> Asked:
        """What the report is asked to be about."""
        return Asked(self.design, self.pinned, tuple(self.methods), self.units.length, self.units.time)
