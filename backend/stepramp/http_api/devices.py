"""Routes over the attached controllers: connecting, ramps and settings, and the WebSocket that tells how they fare."""

import asyncio
from contextlib import suppress

from fastapi import APIRouter, WebSocket, WebSocketDisconnect

from stepramp.controllers.devices import Devices
from stepramp.controllers.settings import Settings
from stepramp.errors import Refused
from stepramp.http_api import jog, motion
from stepramp.http_api.device_models import (
    ConnectRequest,
    DeviceAnswer,
    DevicesAnswer,
    DisconnectedAnswer,
    PortsAnswer,
    PreviewAnswer,
    PushAnswer,
    PushDesigns,
    PushRequest,
)
from stepramp.http_api.device_registry import Acting, Page, Registry
from stepramp.http_api.errors import ErrorList
from stepramp.link.ports import list_serial_ports

EVENT_PAUSE_S = 1 / 50

router = APIRouter(
    tags=["devices"],
    responses={
        404: {"model": ErrorList, "description": "No such device"},
        409: {"model": ErrorList, "description": "Not now: the motor moves, or the controller has no ramp"},
        502: {"model": ErrorList, "description": "The device does not answer, or its port is gone"},
    },
)
router.include_router(motion.router)
router.include_router(jog.router)


@router.get("/ports")
def ports() -> PortsAnswer:
    """Return the ports of this machine, the virtual one last."""
    return PortsAnswer.model_validate({"ports": list_serial_ports()})


@router.get("/devices")
def all_devices(devices: Registry) -> DevicesAnswer:
    """Return the devices that are connected, or were until they were lost."""
    return DevicesAnswer.model_validate({"devices": devices.views()})


@router.post("/devices")
def connect(request: ConnectRequest, devices: Registry, page: Page = None) -> DeviceAnswer:
    """Connect to a port, which takes up to 6 s, and return its device. Nothing moves."""
    device = devices.connect(request.port)
    with suppress(Refused):  # It was connected already, and another page is in control: it stays so.
        devices.acting(device.view.id, page)
    return DeviceAnswer.model_validate(device.view)


@router.get("/devices/{device_id}")
def one_device(device_id: str, devices: Registry) -> DeviceAnswer:
    """Return a device as it is now."""
    return DeviceAnswer.model_validate(devices.get(device_id).view)


@router.delete("/devices/{device_id}")
def disconnect(device: Acting, devices: Registry) -> DisconnectedAnswer:
    """Let go of a device; refused while a motor of it moves."""
    devices.disconnect(device.view.id)
    return DisconnectedAnswer()


@router.post("/devices/{device_id}/control")
def take_over(device_id: str, devices: Registry, page: Page = None) -> DeviceAnswer:
    """Put the page that asks in control, whichever was before. Nothing moves or stops by that but another's jog."""
    if page is None:
        raise Refused("Only a page can be in control: say which in the header X-StepRamp-Page.")
    return DeviceAnswer.model_validate(devices.take_over(device_id, page).view)


@router.post("/devices/{device_id}/push")
def push(request: PushRequest, device: Acting) -> PushAnswer:
    """Have the controller use designs' ramps, stored or on trial, and read them back; refused while a motor moves."""
    return PushAnswer.model_validate(device.push(request.designs, request.first_axis, request.mode))


@router.post("/devices/{device_id}/push/preview")
def preview_push(device_id: str, request: PushDesigns, devices: Registry) -> PreviewAnswer:
    """Return what a push would change of the ramps in use; nothing is sent."""
    preview = devices.get(device_id).preview_push(request.designs, request.first_axis)
    return PreviewAnswer.model_validate(preview)


@router.post("/devices/{device_id}/keep")
def keep(device: Acting) -> DeviceAnswer:
    """Store the ramps and settings that are in use, on trial or not."""
    device.keep()
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/roll_back")
def roll_back(device: Acting) -> DeviceAnswer:
    """Drop the ramps and settings that are on trial: the stored ones are used again."""
    device.roll_back()
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/restore")
def restore(device: Acting) -> DeviceAnswer:
    """Bring back the ramps and settings that were stored before the present ones; a second time brings those back."""
    device.restore()
    return DeviceAnswer.model_validate(device.view)


@router.get("/devices/{device_id}/settings")
def settings(device_id: str, devices: Registry) -> Settings:
    """Return the settings in use."""
    return devices.get(device_id).settings()


@router.put("/devices/{device_id}/settings")
def use_settings(request: Settings, device: Acting) -> Settings:
    """Use other settings, what isn't given being the default; they are on trial until they are kept."""
    device.use_settings(request)
    return device.settings()


@router.websocket("/devices/events")
async def events(socket: WebSocket, devices: Registry, page: str | None = None) -> None:
    """Send all devices at once and after each change, at most 50 times a second; the newest state wins.

    page: what the page that listens calls itself; it can be in control of devices as long as it does.
    """
    await socket.accept()
    loop, changed = asyncio.get_running_loop(), asyncio.Event()

    def wake() -> None:
        with suppress(RuntimeError):  # The server ended in this very moment; nobody listens any more.
            loop.call_soon_threadsafe(changed.set)

    with devices.listening(wake), devices.present(page):
        sender = asyncio.create_task(_send_changes(socket, devices, changed))
        while (await socket.receive())["type"] != "websocket.disconnect":
            pass
        sender.cancel()


async def _send_changes(socket: WebSocket, devices: Devices, changed: asyncio.Event) -> None:
    # Starlette raises one or the other when the page has gone: which one depends on who noticed first.
    with suppress(WebSocketDisconnect, RuntimeError):
        while True:
            changed.clear()
            answer = DevicesAnswer.model_validate({"devices": devices.views()})
            await socket.send_text(answer.model_dump_json())
            await asyncio.sleep(EVENT_PAUSE_S)
            await changed.wait()
