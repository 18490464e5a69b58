"""Routes that plan: a design in, profiles and errors out. They keep nothing."""

from typing import Annotated, Any

from fastapi import APIRouter
from pydantic import Field
from starlette.responses import Response

from stepramp.design import MOST_NAMES, MOST_STEPS, Design, MethodName
from stepramp.examples import all_examples
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.json_response import json_response
from stepramp.http_api.lanes import planning_lane
from stepramp.http_api.planned import Planned
from stepramp.http_api.planning_models import (
    CurveName,
    ErrorsAnswer,
    ExamplesAnswer,
    HealthAnswer,
    ProfileAnswer,
    errors_content,
    profile_content,
)
from stepramp.methods import REFERENCE
from stepramp.ramp.error_curves import all_error_curves
from stepramp.ramp.plan import tuning_report
from stepramp.ramp.profile import profile_of
from stepramp.validation import Document, ListOf, OneOf, Within
from stepramp.version import __version__

router = APIRouter(tags=["planning"], route_class=JsonRoute)

MostPoints = Annotated[
    Annotated[int, Within(10, MOST_STEPS, "points, or null for every step")] | None,
    Field(description="Thin the arrays to about so many steps that keep the curve's shape; null: every step"),
]


class ProfileRequest(Document):
    """A design whose move is to be planned."""

    design: Design
    max_points: MostPoints = None


class ErrorsRequest(Document):
    """A design and the methods that are to be compared."""

    design: Design
    methods: Annotated[list[MethodName], ListOf("method names", most=MOST_NAMES)] = Field(
        description="Methods to compare, each with the design's arithmetic or else the one usual for it"
    )
    reference: MethodName = Field(REFERENCE, description="Method that they are compared with")
    curves: Annotated[list[Annotated[CurveName, OneOf()]], ListOf("curve names", most=MOST_NAMES)] = Field(
        default=["relative_error", "tick_error"], description="Curves wanted; the figures come in any case"
    )
    segment_bound_ticks: Annotated[int, Within(0, 10_000, "ticks, or null for no segments")] | None = Field(
        None,
        description="Judge the move as a controller plays it from segments that keep to this bound [ticks]; null: as "
        "it is planned",
    )
    max_points: MostPoints = None


@router.post("/profile", response_model=ProfileAnswer)
async def profile(request: ProfileRequest) -> Response:
    """Plan a design's move: intervals, times, positions and speeds of its steps, its phases, and a summary."""
    design, points = request.design, request.max_points
    lane = planning_lane([design], points=points)
    return Planned(lane, lambda: profile_content(profile_of(design), tuning_report(design), points))


@router.post("/errors", response_model=ErrorsAnswer)
async def errors(request: ErrorsRequest) -> Response:
    """Compare methods with a reference, step by step: relative error and error in ticks of each interval."""
    lane = planning_lane([request.design], len(request.methods), request.max_points)
    return Planned(lane, lambda: _errors(request))


@router.get("/examples", response_model=ExamplesAnswer)
async def example_designs() -> Response:
    """Return designs to start from."""
    return json_response({"examples": all_examples()})


@router.get("/health")
async def health() -> HealthAnswer:
    """Tell that the server works."""
    return HealthAnswer(status="ok", version=__version__)


def _errors(request: ErrorsRequest) -> dict[str, Any]:
    judged = all_error_curves(request.design, request.methods, request.reference, request.segment_bound_ticks)
    return errors_content(request.reference, judged, request.curves, request.max_points)
