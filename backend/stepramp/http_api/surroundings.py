"""Routes over what is around a virtual controller, so that its inputs can be tried without hardware."""

from fastapi import APIRouter

from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.device_registry import Acting, Registry
from stepramp.http_api.lanes import ACTING
from stepramp.http_api.surroundings_models import SurroundingsAnswer, SurroundingsPayload

router = APIRouter(route_class=JsonRoute)


@router.get("/devices/{device_id}/surroundings")
@ACTING.serves
def surroundings(device_id: str, devices: Registry) -> SurroundingsAnswer:
    """Return what is around a virtual controller; refused of any other."""
    return SurroundingsAnswer.model_validate(devices.get(device_id).surroundings())


@router.put("/devices/{device_id}/surroundings")
@ACTING.serves
def change_surroundings(request: SurroundingsPayload, device: Acting) -> SurroundingsAnswer:
    """Press or release what is around a virtual controller, and put its limit switches elsewhere; refused of any other.

    They are wired to the inputs that the settings name for them: without such an input, nothing comes of it.
    """
    return SurroundingsAnswer.model_validate(device.change_surroundings(request.change))
