"""Routes over the history of pushes, and over the devices that the library has seen."""

from fastapi import APIRouter

from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.device_registry import Keeper
from stepramp.http_api.error_items import ErrorList
from stepramp.http_api.history_models import (
    PushedToAnswer,
    PushedToWithDesignsAnswer,
    PushesAnswer,
    PushesPayload,
    SeenDevicesAnswer,
)
from stepramp.http_api.lanes import LIBRARY

router = APIRouter(prefix="/library", tags=["library"], route_class=JsonRoute)


@router.get("/devices")
@LIBRARY.serves
def seen_devices(keeper: Keeper) -> SeenDevicesAnswer:
    """Return the controllers that were ever connected, that seen last first; the virtual one is none."""
    return SeenDevicesAnswer.model_validate({"devices": keeper.settled().devices()})


@router.post("/pushes/search")
@LIBRARY.serves
def pushes(request: PushesPayload, keeper: Keeper) -> PushesAnswer:
    """Return what was pushed, the newest first: to all devices, to one, or of one design of the library."""
    count, found = keeper.settled().pushes(request.device_id, request.design_id, request.first, request.most)
    return PushesAnswer.model_validate({"count": count, "pushes": found})


@router.get("/pushes/{push_id}", responses={404: {"model": ErrorList, "description": "There is no such push"}})
@LIBRARY.serves
def push(push_id: str, keeper: Keeper) -> PushedToWithDesignsAnswer:
    """Return a push with the design of each axis, and what was read back."""
    told, report, designs = keeper.settled().push(push_id)
    about = PushedToAnswer.model_validate(told).model_dump()
    given = [{"axis": axis, "design": design} for axis, design in sorted(designs.items())]
    return PushedToWithDesignsAnswer.model_validate(about | {"report": report, "designs": given})
