"""Routes over the attached controllers, and the WebSocket that tells how they fare."""

import asyncio
from contextlib import suppress
from typing import Annotated

from fastapi import APIRouter, Depends, WebSocket, WebSocketDisconnect
from starlette.requests import HTTPConnection

from stepramp.controllers.devices import Devices
from stepramp.http_api.device_models import (
    ConnectRequest,
    DeviceAnswer,
    DevicesAnswer,
    DisconnectedAnswer,
    MoveRequest,
    PortsAnswer,
    PushAnswer,
    PushRequest,
)
from stepramp.http_api.errors import ErrorList
from stepramp.link.ports import list_serial_ports

EVENT_PAUSE_S = 1 / 20

router = APIRouter(
    tags=["devices"],
    responses={
        404: {"model": ErrorList, "description": "No such device"},
        409: {"model": ErrorList, "description": "Not now: the motor moves, or the controller has no ramp"},
        502: {"model": ErrorList, "description": "The device does not answer, or its port is gone"},
    },
)


def registry(connection: HTTPConnection) -> Devices:
    """Return the application's devices."""
    devices: Devices = connection.app.state.devices
    return devices


Registry = Annotated[Devices, Depends(registry)]


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


@router.post("/devices/stop")
def stop_all(devices: Registry) -> DevicesAnswer:
    """Stop every device, whatever it does."""
    devices.stop_all()
    return DevicesAnswer.model_validate({"devices": devices.views()})


@router.get("/devices/{device_id}")
def one_device(device_id: str, devices: Registry) -> DeviceAnswer:
    """Return a device as it is now."""
    return DeviceAnswer.model_validate(devices.get(device_id).view)


@router.delete("/devices/{device_id}")
def disconnect(device_id: str, devices: Registry) -> DisconnectedAnswer:
    """Let go of a device; refused while its motor moves."""
    devices.disconnect(device_id)
    return DisconnectedAnswer()


@router.post("/devices/{device_id}/push")
def push(device_id: str, request: PushRequest, devices: Registry) -> PushAnswer:
    """Store a design's ramp in the controller and read it back; refused while its motor moves."""
    return PushAnswer.model_validate(devices.get(device_id).push(request.design))


@router.post("/devices/{device_id}/move")
def move(device_id: str, request: MoveRequest, devices: Registry) -> DeviceAnswer:
    """Begin to move with the stored ramp, by so many steps or to a position."""
    device = devices.get(device_id)
    if request.to_steps is not None:
        device.move_to(request.to_steps)
    else:
        device.move_by(request.by_steps or 0)
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/stop")
def stop(device_id: str, devices: Registry) -> DeviceAnswer:
    """Slow down with the ramp, before anything else that was asked for."""
    device = devices.get(device_id)
    device.stop().result()
    return DeviceAnswer.model_validate(device.view)


@router.post("/devices/{device_id}/halt")
def halt(device_id: str, devices: Registry) -> DeviceAnswer:
    """Make no further step, before anything else that was asked for. A fast motor may slip."""
    device = devices.get(device_id)
    device.halt().result()
    return DeviceAnswer.model_validate(device.view)


@router.websocket("/devices/events")
async def events(socket: WebSocket, devices: Registry) -> None:
    """Send all devices at once and after each change, at most 20 times a second; the newest state wins."""
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
