"""The route for targets and speeds that change in flight. It keeps nothing, and moves nothing."""

from fastapi import APIRouter

from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.lanes import LONG_PLANNING
from stepramp.http_api.planned import Planned
from stepramp.http_api.retarget_models import RetargetAnswer, RetargetPayload
from stepramp.ramp.retarget import played_towards

router = APIRouter(tags=["planning"], route_class=JsonRoute)


@router.post("/retarget")
async def retarget(request: RetargetPayload) -> Planned[RetargetAnswer]:
    """Play a design's ramp as a controller does whose target or speed changes in flight: each of its steps."""
    design = request.design

    def answer() -> RetargetAnswer:
        played = played_towards(design, request.told, request.direction_setup_us)
        return RetargetAnswer.of(played, design.timer.frequency_hz, request.max_points)

    return Planned(LONG_PLANNING, answer)
