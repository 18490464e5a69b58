"""The WebSocket of a jog: an axis runs while the page, tab or program at its other end says so, and no longer."""

import asyncio
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial

from fastapi import APIRouter, WebSocket

from stepramp.devices.device import Device
from stepramp.devices.leases import JOG_S, Lease
from stepramp.devices.stops import Order
from stepramp.errors import Refused, Rejected, Rejection, StepRampError, TooOften
from stepramp.http_api.device_registry import Registry, page_at
from stepramp.http_api.jog_models import JogPayload
from stepramp.http_api.lanes import ACTING
from stepramp.http_api.request_numbers import arrived_at, as_known
from stepramp.http_api.sockets import accept, parsed, received, served, tell_error

ALLOWED = 'a JSON object such as {"do": "hold"}'
RAN_OUT = f"The jog ended: it was not told to go on for {JOG_S:g} s, and the axis slowed down. Begin it again."
TAKEN = "The jog ended: its page is no longer in control of the device, and the axis slowed down."
MOST_BEGINNING = 100
"""So many speeds of one socket may wait for the controller: no hand is as quick, and others want their turns."""
TOO_MANY = f"The jog ended: {MOST_BEGINNING} speeds wait for the controller already. Ask for the next once it has one."
LONGEST_MESSAGE = 1024
"""Longer ones are refused unread: whoever is held up by them can't renew a lease."""

router = APIRouter()


@router.websocket("/devices/{device_id}/jog")
async def jog(socket: WebSocket, device_id: str, devices: Registry, page: str | None = None) -> None:
    """Run an axis for as long as it is told to, at least every 0.4 s; it slows down when that stops or the socket ends.

    What is refused is answered as by the other routes: an object with `errors`. After a stop of the device, jog over
    another socket.
    """
    async with served(socket):
        await accept(socket)
        its_page = page_at(socket, page)
        held = _Held(socket, devices.acting(device_id, its_page), devices.order, its_page)
        try:
            while True:
                await held.take(await received(socket))
        finally:
            held.let_go()


class _Held:
    """What one socket holds: nothing, or the lease of a jog.

    While an axis gets another speed, the lease that it has run on goes on, too: ended before the controller has granted
    the new one, the axis would slow down in between, and that would count as a stop.
    """

    def __init__(self, socket: WebSocket, device: Device, order: Order, page: str | None) -> None:
        self._socket = socket
        self._device = device
        self._order = order
        self._page = page
        # A stop ends a jog for good: messages that were on their way, or a finger that still presses, begin nothing.
        self._opened = arrived_at(socket)
        self._lease: Lease | None = None
        self._before: set[Lease] = set()
        self._beginning: set[asyncio.Task[None]] = set()

    async def take(self, message: str | bytes) -> None:
        """Do what a message asks for; slow down when it makes no sense."""
        try:
            if len(message) > LONGEST_MESSAGE:
                raise Rejected([Rejection("message", message, f"{ALLOWED}, of up to {LONGEST_MESSAGE:,} characters")])
            request = JogPayload.checked(parsed(message, ALLOWED))
            request_number = self._asked_at(request)
        except Rejected as error:
            self.let_go()
            await tell_error(self._socket, error)
            return
        if request.do == "run" and self._lease is not None and not self._lease.holds:
            # It was to get another speed, not to begin: what has slowed down is not set in motion by that.
            await self._hold(self._lease)
        elif request.do == "run" and len(self._beginning) == MOST_BEGINNING:
            self.let_go()
            await tell_error(self._socket, TooOften(TOO_MANY))
        elif request.do == "run":
            before, self._lease = self._lease, Lease({request.axis: request.command.value}, JOG_S, self._page)
            task = asyncio.create_task(self._begin(self._lease, before, request, request_number))
            self._beginning.add(task)
            task.add_done_callback(self._beginning.discard)
        elif request.do == "hold" and self._lease is not None:
            await self._hold(self._lease)
        elif request.do == "end":
            self.let_go()

    def _asked_at(self, request: JogPayload) -> int:
        return self._opened if request.stops is None else as_known(self._opened, request.stops, self._order, "stops")

    async def _hold(self, lease: Lease) -> None:
        """Have an axis go on. When it can't, nobody has let go of it: who holds it has to know why it slows down."""
        for former in self._before:
            former.renew()
        why = RAN_OUT if not lease.renew() else None if lease.holds_with(self._device.view.in_control) else TAKEN
        if why is not None:
            self.let_go()
            await tell_error(self._socket, Refused(why))

    def let_go(self) -> None:
        """Slow down what runs."""
        lease, self._lease = self._lease, None
        for each in (*self._before, *([] if lease is None else [lease])):
            self._device.end_run(each)

    async def _begin(self, lease: Lease, before: Lease | None, request: JogPayload, request_number: int) -> None:
        # In a thread of its own: the messages that renew the lease or end it must not wait for the controller.
        async with served(self._socket):
            try:
                with self._going_on(before, request.axis):
                    await ACTING.run(
                        partial(self._device.run, [request.command], lease, request_number), self._device.view.id
                    )
            except StepRampError as error:
                await tell_error(self._socket, error)

    @contextmanager
    def _going_on(self, before: Lease | None, axis: int) -> Iterator[None]:
        """Have an axis go on until it has another speed; another axis that was held slows down at once."""
        if before is None:
            yield
            return
        if set(before.speeds) != {axis}:
            self._device.end_run(before)
        self._before.add(before)
        try:
            yield
        finally:
            self._before.discard(before)
            self._device.end_run(before)
