"""The routes that stop. Nothing stands between them and the device: no thread, no queue, no check of the body."""

import asyncio
from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from contextlib import contextmanager

from fastapi import APIRouter
from starlette.requests import ClientDisconnect, Request

from stepramp.devices.device import Device
from stepramp.devices.registry import Devices
from stepramp.devices.stopping import NotStopped
from stepramp.errors import DeviceLost, Refused, StepRampError
from stepramp.http_api.answered import LastResponse, until_answered
from stepramp.http_api.device_registry import Registry
from stepramp.http_api.devices_models import DeviceAnswer
from stepramp.http_api.error_items import ErrorItem, error_items
from stepramp.http_api.stop_body import MOST_BYTES, axes_of_stop
from stepramp.http_api.stopping_models import AllStoppedAnswer, AxesPayload

BODY_WITHIN_S = 0.25
"""How long the names of axes are waited for [s]. Without them all are stopped."""

router = APIRouter()
AXES_IN_BODY = {
    "requestBody": {
        "description": "Which axes. A body that is missing, late or can't be understood stops all",
        "content": {"application/json": {"schema": AxesPayload.model_json_schema()}},
    }
}


@router.post("/devices/stop", response_model=AllStoppedAnswer)
async def stop_all(devices: Registry, request: Request) -> LastResponse:
    """Stop every device, whatever it does, before anything else. What was asked before moves nothing afterwards.

    The answer tells what was last heard of each. One that is lost or still being connected may move on: it is stopped
    as soon as it answers, and `errors` says so. One that refuses to stop goes on, and `errors` says why.
    """
    until_answered(request.scope, devices.being_stopped())
    owed = await stop_every(devices)
    told = {"errors": owed} if owed else {}
    return LastResponse(lambda: AllStoppedAnswer.model_validate({"devices": devices.views(), **told}))


@router.post("/devices/{device_id}/stop", response_model=DeviceAnswer, openapi_extra=AXES_IN_BODY)
async def stop(device_id: str, devices: Registry, request: Request) -> LastResponse:
    """Slow axes, or all, down with their ramps, before anything else. What was asked before moves nothing any more.

    A device that is lost or still being connected is stopped as soon as it answers; the error says so. One that refuses
    to stop, as a printer that prints, goes on; the error says why.
    """
    device = devices.get(device_id)
    until_answered(request.scope, device.being_stopped())
    with _told_as_owed():
        await _granted(device.stop(await _axes(request)))
    return LastResponse(lambda: DeviceAnswer.model_validate(device.view))


@router.post("/devices/{device_id}/halt", response_model=DeviceAnswer, openapi_extra=AXES_IN_BODY)
async def halt(device_id: str, devices: Registry, request: Request) -> LastResponse:
    """Make no further step, before anything else; a fast motor may slip. What was asked before moves nothing.

    A device that is lost or still being connected is halted as soon as it answers; the error says so.
    """
    device = devices.get(device_id)
    until_answered(request.scope, device.being_stopped())
    with _told_as_owed():
        await _granted(device.halt(await _axes(request)))
    return LastResponse(lambda: DeviceAnswer.model_validate(device.view))


async def stop_every(devices: Devices) -> list[ErrorItem]:
    """Stop every device: return once all stops are granted or have failed, with why those did."""
    with devices.being_stopped():
        failures = await _settled(devices.begin_to_stop())
    return [item for failure in failures for item in error_items(_as_owed(failure))]


async def halt_whole(device: Device) -> None:
    """Halt all axes of a device: return once that is granted, raise as Device.halt when it can't be."""
    with device.being_stopped():
        await _granted(device.halt())


@contextmanager
def _told_as_owed() -> Iterator[None]:
    """Say of a stop that can't be granted yet that it isn't forgotten."""
    try:
        yield
    except (DeviceLost, Refused) as error:
        raise _as_owed(error) from error


def _as_owed(error: StepRampError) -> StepRampError:
    if isinstance(error, NotStopped):
        return Refused(f"{error} It isn't told to stop again by itself.")
    kind = DeviceLost if isinstance(error, DeviceLost) else Refused
    return kind(f"{error} It is stopped as soon as it answers.")


async def _axes(request: Request) -> Sequence[int] | None:
    """Return which axes a request names, None for all."""
    try:
        return axes_of_stop(await asyncio.wait_for(_begin_of_body(request), BODY_WITHIN_S))
    except (TimeoutError, ClientDisconnect):
        return None


async def _begin_of_body(request: Request) -> bytes:
    """Return a body, or so much of it that it can't be understood any more."""
    body = b""
    async for chunk in request.stream():
        body += chunk
        if len(body) > MOST_BYTES:
            break
    return body


async def _granted(stopped: "Future[None]") -> None:
    """Wait until a stop is granted. It goes on when whoever asked for it no longer waits."""
    await asyncio.shield(asyncio.wrap_future(stopped))
    # Whatever has come in by now is read while nothing may move: it was asked for before the answer.
    # Four turns of the loop: two until a new connection is accepted, one until it is read from, one until that is done.
    # Who is further back among those that connect isn't waited for: see Connections.make_unread_as_old_as.
    for _ in range(4):
        await asyncio.sleep(0)


async def _settled(stopped: Sequence["Future[None]"]) -> list[StepRampError]:
    """Wait until all stops are granted or have failed; return why those did."""
    results = await asyncio.gather(*map(_granted, stopped), return_exceptions=True)
    for result in results:
        if isinstance(result, BaseException) and not isinstance(result, StepRampError):
            raise result
    return [result for result in results if isinstance(result, StepRampError)]
