"""The route that tells what controllers play that work their intervals out themselves. It keeps nothing."""

from fastapi import APIRouter

from stepramp.controllers.own_ramp import Beside
from stepramp.errors import NotFound, Refused, shown
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.device_registry import Registry
from stepramp.http_api.lanes import planning_lane
from stepramp.http_api.own_ramps_models import UNPLAYED, OwnRampAnswer, OwnRampPayload
from stepramp.http_api.planned import Planned

router = APIRouter(tags=["planning"], route_class=JsonRoute, responses={404: {"description": "No such family"}})


@router.post("/families/{name}/ramp", responses=UNPLAYED)
async def own_ramp(name: str, request: OwnRampPayload, devices: Registry) -> Planned[OwnRampAnswer]:
    """Work out what a controller of a family really plays of a design's move, beside what is planned."""
    family = devices.families.get(name)
    if family is None:
        raise NotFound(f"There is no family {shown(name)}.")
    play = family.play_own
    if play is None:
        raise Refused(f"{family.title} plays the planned intervals, or it isn't known which.")
    return Planned(
        planning_lane([request.design], 2, request.max_points),
        lambda: OwnRampAnswer.of(Beside.of(request.design, play, request.steps_per_mm), request.max_points),
    )
