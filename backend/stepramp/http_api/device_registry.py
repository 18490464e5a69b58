"""How the routes come by the application's devices."""

from typing import Annotated

from fastapi import Depends
from starlette.requests import HTTPConnection

from stepramp.controllers.devices import Devices


def registry(connection: HTTPConnection) -> Devices:
    """Return the application's devices."""
    devices: Devices = connection.app.state.devices
    return devices


Registry = Annotated[Devices, Depends(registry)]
