"""Routes over what is saved of attached controllers before they are written to."""

from typing import Any

from fastapi import APIRouter
from starlette.responses import Response

from stepramp.http_api.backups_models import ArchiveAnswer, BackupsAnswer, RestoredAnswer, RestorePayload
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.device_registry import Acting, Registry
from stepramp.http_api.devices_models import DeviceAnswer
from stepramp.http_api.imports_models import BasePayload, ImportAnswer
from stepramp.http_api.lanes import ACTING, CONNECTING, PUSHING

router = APIRouter(route_class=JsonRoute)

_TEXT: dict[str, Any] = {"text/plain": {"schema": {"type": "string"}}}


@router.get("/backups")
@ACTING.serves
def archive(devices: Registry) -> ArchiveAnswer:
    """Return all backups that there are, also of controllers that aren't connected.

    What is in a folder that may not be entered isn't among them: `unreadable` names it.
    """
    return ArchiveAnswer.model_validate(devices.archive.all())


@router.get("/backups/{source}/{name}", response_class=Response, responses={200: {"content": _TEXT}})
@ACTING.serves
def archived(source: str, name: str, devices: Registry) -> Response:
    """Return a backup as the text that the controller told."""
    return Response(devices.archive.read(source, name), media_type="text/plain")


@router.get("/devices/{device_id}/backups")
@ACTING.serves
def backups(device_id: str, devices: Registry) -> BackupsAnswer:
    """Return the backups of a device, the newest first."""
    return BackupsAnswer.model_validate(devices.get(device_id).backups())


@router.post("/devices/{device_id}/backups")
@PUSHING.serves
def back_up(device: Acting) -> BackupsAnswer:
    """Save what the controller has now; the first push over each connection does that by itself."""
    device.back_up()
    return BackupsAnswer.model_validate(device.backups())


@router.get("/devices/{device_id}/backups/{name}", response_class=Response, responses={200: {"content": _TEXT}})
@ACTING.serves
def backup(device_id: str, name: str, devices: Registry) -> Response:
    """Return a backup as the text that the controller told."""
    return Response(devices.get(device_id).saved_text(name), media_type="text/plain")


@router.post("/devices/{device_id}/backups/{name}/restore")
@PUSHING.serves
def restore_backup(name: str, device: Acting) -> RestoredAnswer:
    """Write what differs of a backup, one setting at a time, and read it back; refused while a motor moves."""
    remarks = device.restore_backup(name)
    return RestoredAnswer(device=DeviceAnswer.model_validate(device.view), remarks=list(remarks))


@router.post("/devices/{device_id}/backups/restore")
@PUSHING.serves
def restore_any_backup(request: RestorePayload, device: Acting, devices: Registry) -> RestoredAnswer:
    """Write any backup of the family, also one of before it was plugged in elsewhere; as the route above."""
    text = devices.archive.read(request.source, request.name)
    remarks = device.restore_from(devices.archive.source(request.source), request.name, text)
    return RestoredAnswer(device=DeviceAnswer.model_validate(device.view), remarks=list(remarks))


@router.post("/devices/{device_id}/prove")
@CONNECTING.serves
def prove(device: Acting) -> DeviceAnswer:
    """Start the controller anew, by closing its port and opening it again, and compare what it has stored.

    It forgets where it is by that: its axes have `unknown_positions` then. This takes up to 5 s, in which it is
    `connecting`: a stop that comes then is carried out as soon as it is there again. What has come of it `proof` tells.
    Refused with 409 while a motor moves, where start-up lines may move something, where nothing is `unproven`, over
    `socket://`, and when it wasn't heard to start: then it is proven at its next start.
    """
    device.prove()
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/import")
@ACTING.serves
def designs_of_device(device_id: str, request: BasePayload, devices: Registry) -> ImportAnswer:
    """Return what a controller has now as designs, one for each of its axes: to start from this machine."""
    device = devices.get(device_id)
    return ImportAnswer.model_validate({"family": device.view.family, "axes": device.present_designs(request.base)})
