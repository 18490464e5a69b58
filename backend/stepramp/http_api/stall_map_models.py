"""What the route about stall maps takes and answers."""

from typing import Self

from pydantic import Field

from stepramp.design import Design
from stepramp.http_api.answer import Answer, Numbers, WholeNumberRows
from stepramp.motor.asked import MapAsked
from stepramp.motor.map_points import SPACINGS, Over, Question, Spacing, own_value
from stepramp.motor.map_ranges import UNITS
from stepramp.motor.stall_map import Picture


class MapPayload(MapAsked):
    """A design with its motor, and what is to be varied."""

    design: Design


class StartedAnswer(Answer):
    """A job that has been begun, or was before: GET /jobs/{id}."""

    id: str = Field(description="Of the job")


class DesignPointAnswer(Answer):
    """The design itself, which lies between the points."""

    acceleration_steps_per_s2: float = Field(description="Its own [steps/s²]")
    over_value: float = Field(description="Its own of what the map goes over")
    verdict: int = Field(description="As in the map")


class StallMapAnswer(Answer):
    """Whether the motor makes the design's move, over its acceleration and another value. Arrays of n = cells + 1."""

    over: Over = Field(description="What is varied beside the acceleration")
    over_values: Numbers = Field(description="One a column, increasing, shape (n,)")
    over_unit: str = Field(description="Of these")
    over_spacing: Spacing = Field(
        description="Whether these are evenly apart, or each in the same ratio to the one before, as the accelerations"
    )
    accelerations_steps_per_s2: Numbers = Field(description="One a row, increasing, shape (n,)")
    verdicts: WholeNumberRows = Field(
        description="-1 not known yet, 0 safe, 1 marginal, 2 stalls, 3 not possible: it is refused, as beyond the "
        "timer; shape (n, n)"
    )
    played: int = Field(description="How many points were played; the others lie within equal ones")
    design_point: DesignPointAnswer

    @classmethod
    def of(cls, question: Question, own: int, picture: Picture) -> Self:
        """Return a picture as an answer. own: the design's verdict."""
        return cls(
            over=question.over,
            over_values=list(question.over_values),
            over_unit=UNITS[question.over],
            over_spacing=SPACINGS[question.over],
            accelerations_steps_per_s2=list(question.accelerations),
            verdicts=picture.verdicts,
            played=picture.played,
            design_point=DesignPointAnswer(
                acceleration_steps_per_s2=question.design.ramp.acceleration_steps_per_s2,
                over_value=own_value(question.design, question.over),
                verdict=own,
            ),
        )
