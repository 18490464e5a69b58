"""How the routes come by the application's devices, and who asks."""

from typing import Annotated

from fastapi import Depends, Header
from starlette.requests import HTTPConnection

from stepramp.devices.device import Device
from stepramp.devices.registry import Devices


async def registry(connection: HTTPConnection) -> Devices:
    """Return the application's devices."""
    devices: Devices = connection.app.state.devices
    return devices


Registry = Annotated[Devices, Depends(registry)]
Page = Annotated[
    str | None,
    Header(
        alias="X-StepRamp-Page",
        description="Which page asks, if one does: the `page` that its WebSocket of events was opened with. While "
        "another page is in control of the device, it is refused with 409; programs leave it out",
    ),
]


async def acting(device_id: str, devices: Registry, page: Page = None) -> Device:
    """Return a device for somebody who acts on it; Refused for a page while another one is in control."""
    return devices.acting(device_id, page)


Acting = Annotated[Device, Depends(acting)]
