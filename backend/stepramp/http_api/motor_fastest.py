"""The route that finds the fastest ramps that a motor makes safely. It keeps nothing, and moves nothing."""

from fastapi import APIRouter

from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.lanes import LONG_PLANNING
from stepramp.http_api.motor_fastest_models import FastestAnswer, FastestPayload
from stepramp.http_api.planned import Planned, Wanted
from stepramp.motor.fastest import fastest_of

router = APIRouter(prefix="/motor", tags=["motor"], route_class=JsonRoute)


@router.post("/fastest")
async def fastest(request: FastestPayload) -> Planned[FastestAnswer]:
    """Find the fastest safe ramp of each shape with the same part of the torque kept back, and what torque gains."""
    design, margin, wanted = request.design, request.margin, Wanted()
    return Planned(LONG_PLANNING, lambda: FastestAnswer.of(fastest_of(design, margin, wanted.is_so)), wanted=wanted)
