"""The WebSocket of a jog: an axis runs while the page, tab or program at its other end says so, and no longer."""

import asyncio
from contextlib import suppress

from fastapi import APIRouter, WebSocket, WebSocketDisconnect

from stepramp.controllers.device import Device
from stepramp.controllers.jog_lease import JogLease
from stepramp.errors import Rejected, StepRampError
from stepramp.http_api.device_registry import Registry
from stepramp.http_api.errors import error_items
from stepramp.http_api.motion_models import JogRequest
from stepramp.http_api.sockets import parsed

router = APIRouter()


@router.websocket("/devices/{device_id}/jog")
async def jog(socket: WebSocket, device_id: str, devices: Registry, page: str | None = None) -> None:
    """Run an axis for as long as it is told to, at least every 0.4 s; it slows down when that stops or the socket ends.

    What is refused is answered as by the other routes: an object with `errors`.
    """
    await socket.accept()
    try:
        device = devices.acting(device_id, page)
    except StepRampError as error:
        await socket.send_json({"errors": error_items(error)})
        await socket.close(1008)
        return
    held = _Held(socket, device)
    # Starlette raises one or the other when the page has gone: which one depends on who noticed first.
    with suppress(WebSocketDisconnect, RuntimeError):
        try:
            while True:
                await held.take(await socket.receive_text())
        finally:
            held.let_go()


class _Held:
    """What one socket holds: nothing, or the lease of a jog."""

    def __init__(self, socket: WebSocket, device: Device) -> None:
        self._socket = socket
        self._device = device
        self._lease: JogLease | None = None
        self._beginning: set[asyncio.Task[None]] = set()

    async def take(self, text: str) -> None:
        """Do what a message asks for."""
        try:
            request = JogRequest.checked(parsed(text, 'a JSON object such as {"do": "hold"}'))
        except Rejected as error:
            self.let_go()
            await self._socket.send_json({"errors": error_items(error)})
            return
        if request.do == "run":
            if self._lease is not None:
                self._lease.end()
            self._lease = JogLease(request.axis)
            task = asyncio.create_task(self._begin(self._lease, request))
            self._beginning.add(task)
            task.add_done_callback(self._beginning.discard)
        elif request.do == "hold" and self._lease is not None:
            self._lease.renew()
        elif request.do == "end":
            self.let_go()

    def let_go(self) -> None:
        """Slow down what runs."""
        lease, self._lease = self._lease, None
        if lease is not None:
            self._device.end_jog(lease)

    async def _begin(self, lease: JogLease, request: JogRequest) -> None:
        # In a thread of its own: the messages that renew the lease or end it must not wait for the controller.
        try:
            await asyncio.to_thread(self._device.jog, lease, request.asked)
        except StepRampError as error:
            with suppress(WebSocketDisconnect, RuntimeError):
                await self._socket.send_json({"errors": error_items(error)})
