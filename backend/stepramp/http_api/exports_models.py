"""What the route for files takes."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from stepramp.design import MOST_NAMES, Design, MethodName
from stepramp.exports.machines.sheet import AxisLetter
from stepramp.exports.names import NAME_RULE, is_identifier
from stepramp.http_api.answer import Answer
from stepramp.http_api.error_items import TOLD_OF_EACH, ToldAnswer
from stepramp.numerics.numbers import Arithmetic
from stepramp.validation import Document, ListOf, Within, refuse

MOST_BOUND_TICKS = 10_000


class ExportPayload(Document):
    """A design, and what its file should be like."""

    design: Design
    name: str | None = Field(
        None, description="Begin of the file's name and of the names in C; null: made of the design's name"
    )
    methods: Annotated[list[MethodName], ListOf("method names", most=MOST_NAMES)] = Field(
        default=[], description="html, svg, png: methods that the design's own is compared with"
    )
    arithmetic: Arithmetic | None = Field(
        None,
        description="C code of a formula: its numbers; null: the design's own when the formula is its method, else the "
        "ones usual for it",
    )
    segment_bound_ticks: Annotated[int, Within(0, MOST_BOUND_TICKS, "ticks")] = Field(
        0, description="Ramps as segments: how far an interval may be from the planned one, for fewer segments [ticks]"
    )

    axis_letter: AxisLetter = Field(
        "X", description="Machines that ramp by themselves: which of their axes the design is for"
    )

    @model_validator(mode="after")
    def _name_fits_in_c(self) -> Self:
        if self.name is not None and not is_identifier(self.name):
            refuse("name", self.name, NAME_RULE)
        return self


class SettingAnswer(Answer):
    """One figure that a machine is given."""

    name: str = Field(description="As the machine calls it")
    unit: str = Field(description="Of both numbers; empty for a mere number")
    requested: float = Field(description="What the design asks for, before it was rounded")
    sent: str = Field(description="The number as the machine reads it")


class MachineAnswer(Answer):
    """What a machine that ramps by itself is given for a design, and what it loses of it."""

    file_name: str
    text: str = Field(description="The file")
    settings: list[SettingAnswer]
    remarks: list[str] = Field(description="What of the design is lost, each with its figure, and what else to know")
    remarks_told: list[list[ToldAnswer]] = Field(description=TOLD_OF_EACH)
    unplayed: str | None = Field(
        description="Why it isn't known what it really plays, as a sentence; null: `/machine/{machine}/ramp` tells it"
    )
