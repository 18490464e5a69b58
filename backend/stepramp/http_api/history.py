"""Routes over the history of pushes, and over the devices that the library has seen."""

from typing import Annotated

from fastapi import APIRouter, Depends, Request

from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.errors_models import ErrorList
from stepramp.http_api.history_keeper import HistoryKeeper
from stepramp.http_api.history_models import (
    PushedToAnswer,
    PushedToWithDesignsAnswer,
    PushesAnswer,
    PushesPayload,
    SeenDevicesAnswer,
)
from stepramp.http_api.lanes import LIBRARY
from stepramp.library.history import History

router = APIRouter(prefix="/library", tags=["library"], route_class=JsonRoute)


def _settled(request: Request) -> History:
    """Return the history with all that has been answered so far."""
    keeper: HistoryKeeper = request.app.state.history_keeper
    keeper.settle()
    return keeper.history


TheHistory = Annotated[History, Depends(_settled)]


@router.get("/devices")
@LIBRARY.serves
def seen_devices(history: TheHistory) -> SeenDevicesAnswer:
    """Return the controllers that were ever connected, that seen last first; the virtual one is none."""
    return SeenDevicesAnswer.model_validate({"devices": history.devices()})


@router.post("/pushes/search")
@LIBRARY.serves
def pushes(request: PushesPayload, history: TheHistory) -> PushesAnswer:
    """Return what was pushed, the newest first: to all devices, to one, or of one design of the library."""
    count, found = history.pushes(request.device_id, request.design_id, request.first, request.most)
    return PushesAnswer.model_validate({"count": count, "pushes": found})


@router.get("/pushes/{push_id}", responses={404: {"model": ErrorList, "description": "There is no such push"}})
@LIBRARY.serves
def push(push_id: str, history: TheHistory) -> PushedToWithDesignsAnswer:
    """Return a push with the design of each axis, and what was read back."""
    told, report, designs = history.push(push_id)
    about = PushedToAnswer.model_validate(told).model_dump()
    given = [{"axis": axis, "design": design} for axis, design in sorted(designs.items())]
    return PushedToWithDesignsAnswer.model_validate(about | {"report": report, "designs": given})
