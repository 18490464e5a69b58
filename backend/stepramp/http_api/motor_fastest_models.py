"""What the route of the fastest ramps takes and answers."""

import math
from typing import Self

from pydantic import Field

from stepramp.design import Design
from stepramp.errors import Rejected
from stepramp.http_api.answer import Answer
from stepramp.http_api.error_items import ChangeAnswer, ErrorItem, error_items, in_body
from stepramp.motor.asked import MarginAsked
from stepramp.motor.fastest import Candidate, Fastest, Figures
from stepramp.motor.fastest_search import SEARCH_S, Shape
from stepramp.motor.verdict import Verdict


class FastestPayload(MarginAsked):
    """A design with its motor, and how much of the motor's torque its ramp may ask for."""

    design: Design


class FiguresAnswer(Answer):
    """What a move is with its motor; null all of it where rejections say why there is none."""

    duration_s: float | None = Field(description="Of the design's move [s]")
    ramp_up_s: float | None = Field(description="Of its acceleration [s]")
    peak_speed_steps_per_s: float | None = Field(description="[steps/s]")
    acceleration_steps_per_s2: float | None = Field(description="Of the design's ramp: at most [steps/s²]")
    most_used: float | None = Field(
        description="The largest part of the pull-out torque that the ramp asks for; null also where there is none"
    )
    verdict: Verdict | None = Field(description="As POST /motor/simulate has it")
    rejections: list[ErrorItem] = Field(description="Why there is no such move; none where there is one")


class PresentAnswer(FiguresAnswer):
    """The design as it is."""

    is_fastest: bool = Field(
        description="Whether its move is the shortest of all: it takes part where it is safe, within the margin"
    )

    @classmethod
    def of_fastest(cls, fastest: Fastest) -> Self:
        """Return it as an answer."""
        best = fastest.best
        return cls(**_figures(fastest.present), is_fastest=best is not None and best.shape is None)


class CandidateAnswer(FiguresAnswer):
    """The fastest ramp of a shape."""

    shape: Shape
    changes: list[ChangeAnswer] = Field(description="What makes it of the design, all together; empty: there is none")
    is_fastest: bool = Field(description="Whether its move is the shortest of all")

    @classmethod
    def of_candidate(cls, candidate: Candidate, best: Candidate | None) -> Self:
        """Return a candidate as an answer."""
        made = candidate.figures or candidate.rejected
        assert made is not None
        assert candidate.shape is not None
        changes = [ChangeAnswer.model_validate(each) for each in candidate.changes]
        return cls(**_figures(made), shape=candidate.shape, changes=changes, is_fastest=candidate is best)


class FastestAnswer(Answer):
    """The fastest ramp of each shape with the same part of the torque kept back, and the design as it is."""

    margin: float = Field(description="m, as it was asked for")
    candidates: list[CandidateAnswer] = Field(description="constant, s_curve and torque, in this order")
    present: PresentAnswer
    gain: float | None = Field(
        description="How many times the move lasts with the better of constant and s_curve what it lasts with torque; "
        "1 or less: nothing is gained; null: one of them isn't there"
    )
    ramp_gain: float | None = Field(description="The same of the ramp up alone; null, too, where it takes no step")
    is_cut_short: bool = Field(
        description=f"Whether the search ended after {SEARCH_S:g} s before all was tried: there may be faster ones"
    )
    words: str = Field(description="What that comes to, in a sentence")

    @classmethod
    def of(cls, fastest: Fastest) -> Self:
        """Return what was found as an answer."""
        return cls(
            margin=fastest.margin,
            candidates=[CandidateAnswer.of_candidate(each, fastest.best) for each in fastest.candidates],
            present=PresentAnswer.of_fastest(fastest),
            gain=fastest.gain,
            ramp_gain=fastest.ramp_gain,
            is_cut_short=fastest.is_cut_short,
            words=fastest.words,
        )


def _figures(made: Figures | Rejected) -> dict[str, object]:
    if isinstance(made, Rejected):
        return dict.fromkeys(Figures.__annotations__) | {"rejections": error_items(in_body(made))}
    most_used = made.most_used if math.isfinite(made.most_used) else None
    return vars(made) | {"most_used": most_used, "rejections": []}
