"""Routes over the attached controllers: connecting, ramps and settings, and the WebSocket that tells how they fare."""

import asyncio
from contextlib import suppress

from fastapi import APIRouter, WebSocket, WebSocketDisconnect

from stepramp.controllers.devices import Devices
from stepramp.controllers.settings import Settings
from stepramp.http_api import motion
from stepramp.http_api.device_models import (
    ConnectRequest,
    DeviceAnswer,
    DevicesAnswer,
    DisconnectedAnswer,
    PortsAnswer,
    PushAnswer,
    PushRequest,
)
from stepramp.http_api.device_registry import Registry
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


@router.get("/ports")
def ports() -> PortsAnswer:
    """Return the ports of this machine, the virtual one last."""
    return PortsAnswer.model_validate({"ports": list_serial_ports()})


@router.get("/devices")
def all_devices(devices: Registry) -> DevicesAnswer:
    """Return the devices that are connected, or were until they were lost."""
    return DevicesAnswer.model_validate({"devices": devices.views()})


@router.post("/devices")
def connect(request: ConnectRequest, devices: Registry) -> DeviceAnswer:
    """Connect to a port, which takes up to 6 s, and return its device. Nothing moves."""
    return DeviceAnswer.model_validate(devices.connect(request.port).view)


@router.get("/devices/{device_id}")
def one_device(device_id: str, devices: Registry) -> DeviceAnswer:
    """Return a device as it is now."""
    return DeviceAnswer.model_validate(devices.get(device_id).view)


@router.delete("/devices/{device_id}")
def disconnect(device_id: str, devices: Registry) -> DisconnectedAnswer:
    """Let go of a device; refused while a motor of it moves."""
    devices.disconnect(device_id)
    return DisconnectedAnswer()


@router.post("/devices/{device_id}/push")
def push(device_id: str, request: PushRequest, devices: Registry) -> PushAnswer:
    """Have the controller use designs' ramps, stored or on trial, and read them back; refused while a motor moves."""
    device = devices.get(device_id)
    if request.axes is not None:
        report = device.push(request.axes, mode=request.mode)
    else:
        assert request.design is not None
        report = device.push([request.design], request.to_axis, request.mode)
    return PushAnswer.model_validate(report)


@router.post("/devices/{device_id}/keep")
def keep(device_id: str, devices: Registry) -> DeviceAnswer:
    """Store the ramps and settings that are in use, on trial or not."""
    device = devices.get(device_id)
    device.keep()
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/roll_back")
def roll_back(device_id: str, devices: Registry) -> DeviceAnswer:
    """Drop the ramps and settings that are on trial: the stored ones are used again."""
    device = devices.get(device_id)
    device.roll_back()
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/restore")
def restore(device_id: str, devices: Registry) -> DeviceAnswer:
    """Bring back the ramps and settings that were stored before the present ones; a second time brings those back."""
    device = devices.get(device_id)
    device.restore()
    return DeviceAnswer.model_validate(device.view)


@router.get("/devices/{device_id}/settings")
def settings(device_id: str, devices: Registry) -> Settings:
    """Return the settings in use."""
    return devices.get(device_id).settings()


@router.put("/devices/{device_id}/settings")
def use_settings(device_id: str, request: Settings, devices: Registry) -> Settings:
    """Use other settings, what isn't given being the default; they are on trial until they are kept."""
    device = devices.get(device_id)
    device.use_settings(request)
    return device.settings()


@router.websocket("/devices/events")
async def events(socket: WebSocket, devices: Registry) -> None:
    """Send all devices at once and after each change, at most 50 times a second; the newest state wins."""
    await socket.accept()
    loop, changed = asyncio.get_running_loop(), asyncio.Event()

    def wake() -> None:
        with suppress(RuntimeError):  # The server ended in this very moment; nobody listens any more.
            loop.call_soon_threadsafe(changed.set)

    with devices.listening(wake):
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
