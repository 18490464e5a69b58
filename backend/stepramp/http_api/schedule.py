"""The route that plans up to four axes together. It keeps nothing."""

from fastapi import APIRouter

from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.lanes import planning_lane
from stepramp.http_api.planned import Planned
from stepramp.http_api.schedule_models import ScheduleAnswer, SchedulePayload
from stepramp.ramp.schedule import schedule_of

router = APIRouter(tags=["planning"], route_class=JsonRoute)


@router.post("/schedule")
async def schedule(request: SchedulePayload) -> Planned[ScheduleAnswer]:
    """Plan up to four axes together: the pulses of each, all in order of time, and where they come too close."""
    designs, points, spacing_us = request.designs, request.max_points, request.shortest_spacing_us
    lane = planning_lane(designs, points=points, field="designs")
    return Planned(lane, lambda: ScheduleAnswer.of(schedule_of(designs, request.mode), spacing_us, points))
