"""How the routes come by the application's devices and jobs, and who asks."""

from typing import Annotated

from fastapi import Depends, Header
from starlette.requests import HTTPConnection

from stepramp.devices.device import Device
from stepramp.devices.pages import page_of
from stepramp.devices.registry import Devices
from stepramp.http_api.bodies import refuse_repeated
from stepramp.http_api.history_keeper import HistoryKeeper
from stepramp.http_api.job_registry import Jobs
from stepramp.http_api.sign_in import client_of


async def registry(connection: HTTPConnection) -> Devices:
    """Return the application's devices."""
    devices: Devices = connection.app.state.devices
    return devices


Registry = Annotated[Devices, Depends(registry)]
PAGE_HEADER = "X-StepRamp-Page"


async def asking_page(
    connection: HTTPConnection,
    page: Annotated[
        str | None,
        Header(
            alias=PAGE_HEADER,
            description="Which page asks, if one does: the `page` that its WebSocket of events was opened with. While "
            "another page is in control of the device, it is refused with 409; programs leave it out",
        ),
    ] = None,
) -> str | None:
    """Return which page asks, None for a program. Raises Rejected when two are named."""
    refuse_repeated(connection.headers, [PAGE_HEADER])
    return page_at(connection, page)


def page_at(connection: HTTPConnection, name: str | None) -> str | None:
    """Return which page it is that calls itself so: one of somebody else, who has heard the name, is another one."""
    client = client_of(connection.scope)
    return None if name is None else page_of(name, None if client is None else client.holder)


async def history_keeper(connection: HTTPConnection) -> HistoryKeeper:
    """Return who notes devices and pushes."""
    keeper: HistoryKeeper = connection.app.state.history_keeper
    return keeper


Keeper = Annotated[HistoryKeeper, Depends(history_keeper)]


async def job_registry(connection: HTTPConnection) -> Jobs:
    """Return the application's jobs."""
    jobs: Jobs = connection.app.state.jobs
    return jobs


JobRegistry = Annotated[Jobs, Depends(job_registry)]


async def asking_client(connection: HTTPConnection) -> str | None:
    """Return what who asks is called; None where nobody is told apart."""
    client = client_of(connection.scope)
    return None if client is None else client.name


ClientName = Annotated[str | None, Depends(asking_client)]
Page = Annotated[str | None, Depends(asking_page)]


async def acting(device_id: str, devices: Registry, page: Page) -> Device:
    """Return a device for somebody who acts on it; Refused for a page while another one is in control."""
    return devices.acting(device_id, page)


Acting = Annotated[Device, Depends(acting)]
