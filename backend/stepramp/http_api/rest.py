"""Answers that wait until a device is at rest."""

import asyncio
from collections.abc import Callable, Coroutine
from contextlib import suppress
from functools import wraps
from inspect import Parameter, signature
from typing import Any

from stepramp.devices.device import Device
from stepramp.devices.registry import Devices
from stepramp.devices.view import UNDER_WAY
from stepramp.http_api.device_registry import Registry
from stepramp.http_api.devices_models import DeviceAnswer
from stepramp.http_api.motion_models import Motion


def then_waits(
    route: Callable[..., Coroutine[Any, Any, DeviceAnswer]],
) -> Callable[..., Coroutine[Any, Any, DeviceAnswer]]:
    """Have a route that begins a motion wait for its end as long as its request says: a decorator."""

    @wraps(route)
    async def waiting(*, devices: Devices, **arguments: Any) -> DeviceAnswer:
        begun = await route(**arguments)
        request: Motion = arguments["request"]
        device: Device = arguments["device"]
        if request.wait_s == 0:
            return begun
        await until_rest(device, devices, request.wait_s)
        return DeviceAnswer.model_validate(device.view)

    taken = signature(route)
    parameters = [*taken.parameters.values(), Parameter("devices", Parameter.KEYWORD_ONLY, annotation=Registry)]
    # The framework looks there for what it is to hand over.
    waiting.__signature__ = taken.replace(parameters=parameters)  # type: ignore[attr-defined]
    return waiting


async def until_rest(device: Device, devices: Devices, within_s: float) -> None:
    """Wait until a device moves no more, or is lost, but no longer than so long [s]. No thread waits meanwhile."""
    loop, changed = asyncio.get_running_loop(), asyncio.Event()

    def wake() -> None:
        with suppress(RuntimeError):  # The server has ended meanwhile.
            loop.call_soon_threadsafe(changed.set)

    with devices.listening(wake), suppress(TimeoutError):
        async with asyncio.timeout(within_s):
            while device.view.state in UNDER_WAY or device.view.shuttle is not None:
                await changed.wait()
                changed.clear()
