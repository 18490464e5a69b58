"""The route that plans up to four axes together. It keeps nothing."""

from typing import Annotated

from fastapi import APIRouter
from pydantic import Field
from starlette.responses import Response

from stepramp.design import Design
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.lanes import planning_lane
from stepramp.http_api.planned import Planned
from stepramp.http_api.planning import MostPoints
from stepramp.http_api.schedule_models import ScheduleAnswer, schedule_content
from stepramp.ramp.schedule import MOST_AXES, Mode, schedule_of
from stepramp.validation import Document, ListOf, OneOf, Within

router = APIRouter(tags=["planning"], route_class=JsonRoute)


class ScheduleRequest(Document):
    """Designs whose moves begin together."""

    designs: Annotated[list[Design], ListOf("designs", most=MOST_AXES, least=1)] = Field(
        description=f"One to {MOST_AXES} designs, one an axis"
    )
    mode: Annotated[Mode, OneOf()] = Field(
        description="independent: each axis plays its own move with its own timer. line: straight in the space of all "
        "axes' steps; the first of the axes with most steps leads, and is slowed to what every axis allows"
    )
    max_points: MostPoints = Field(
        None, description="Thin each axis to about so many steps, the first and the last of them; null: every step"
    )
    shortest_spacing_us: Annotated[float, Within(0, 1_000_000, "µs")] = Field(
        20.0,
        description="Least time that the controller's interrupt needs between two pulses of different axes [µs]",
    )


@router.post("/schedule", response_model=ScheduleAnswer)
async def schedule(request: ScheduleRequest) -> Response:
    """Plan up to four axes together: the pulses of each, all in order of time, and where they come too close."""
    designs, points, spacing_us = request.designs, request.max_points, request.shortest_spacing_us
    lane = planning_lane(designs, points=points)
    return Planned(lane, lambda: schedule_content(schedule_of(designs, request.mode), spacing_us, points))
