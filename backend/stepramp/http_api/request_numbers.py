"""When something was asked for: noted as soon as it arrives, before anything is read, checked or waited for.

A stop overtakes what is slow: a request whose body comes in drops, or that waits for its turn.
"""

from collections.abc import Callable
from typing import Annotated, Any

import h11
from fastapi import Depends, Header
from starlette.datastructures import Headers
from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Receive, Scope, Send
from uvicorn.protocols.http.h11_impl import H11Protocol

from stepramp.devices.stops import Order
from stepramp.errors import Rejected, Rejection
from stepramp.http_api.bodies import refuse_repeated
from stepramp.http_api.connections import Connection, Connections, readable
from stepramp.http_api.device_registry import Registry

STOPS_HEADER = "X-StepRamp-Stops"
MOST_DIGITS = 18
_REQUEST_NUMBER = "stepramp.request_number"


def numbering(now: Callable[[], int], connections: Connections) -> type[H11Protocol]:
    """Return the server's protocol of HTTP, which notes when the first byte of each request arrived.

    Its connections are some of these.

    A request may come in drops, or wait behind another one of its connection: then it is as old as what it waits for.
    """

    class Numbering(Connection):
        def __init__(self, **options: Any) -> None:
            # Of its own, not the server's: what this connection's requests are told.
            super().__init__(connections, **{**options, "app_state": dict(options["app_state"])})
            # Whether something waits to be read that came while this connection wasn't read from.
            self._has_left_unread = False

        def data_received(self, data: bytes) -> None:
            self._has_left_unread = self._has_left_unread and self._is_readable()
            self.app_state.setdefault(_REQUEST_NUMBER, now())
            super().data_received(data)
            self._forget_when_idle()

        def on_response_complete(self) -> None:
            self._has_left_unread = self._has_left_unread or (self.flow.read_paused and self._is_readable())
            super().on_response_complete()
            self._forget_when_idle()

        def make_as_old_as(self, request_number: int) -> None:
            self.app_state.setdefault(_REQUEST_NUMBER, request_number)
            self._has_left_unread = True

        def _forget_when_idle(self) -> None:
            """Have the next request get a number of its own, unless something of it is here already."""
            is_idle = self.conn.our_state is self.conn.their_state is h11.IDLE and not self.conn.trailing_data[0]
            if is_idle and not self._has_left_unread:
                self.app_state.pop(_REQUEST_NUMBER, None)

        def _is_readable(self) -> bool:
            return bool(readable([self.transport.get_extra_info("socket")]))

    return Numbering


class RequestNumbering:
    """Numbers each request and WebSocket that the server's protocol hasn't numbered.

    now: returns the number of the present moment in the order of all that is asked and stopped.
    """

    def __init__(self, app: ASGIApp, now: Callable[[], int]) -> None:
        self.app = app
        self.now = now

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Note when it was asked for, and pass it on."""
        if scope["type"] != "lifespan":
            scope = {**scope, _REQUEST_NUMBER: scope.get("state", {}).get(_REQUEST_NUMBER) or self.now()}
        await self.app(scope, receive, send)


async def latest_known_number(
    connection: HTTPConnection,
    devices: Registry,
    stops: Annotated[
        str | None,
        Header(
            alias=STOPS_HEADER,
            description="The `stops` of the device that whoever asks knows of: when it was stopped since, nothing "
            "moves, and the answer is 409. For what is asked in several steps, or decided before it is sent",
        ),
    ] = None,
) -> int:
    """Return when a request was asked for: as it arrived, or when its sender last heard of the device.

    Raises Rejected when the header says something else.
    """
    refuse_repeated(connection.headers, [STOPS_HEADER])
    arrived = arrived_at(connection)
    if stops is None:
        return arrived
    if not _is_number(stops):
        raise Rejected([Rejection(STOPS_HEADER, stops, "a whole number: the `stops` that the device last told")])
    return as_known(arrived, int(stops), devices.order, STOPS_HEADER)


def as_known(arrived: int, stops: int, order: Order, field: str) -> int:
    """Return when something was asked for by who knew of these stops then. Raises Rejected for what was never told."""
    if stops > order.last_stop:
        allowed = "the `stops` that the device last told: this server has not come so far"
        raise Rejected([Rejection(field, stops, allowed)])
    return min(arrived, stops)


def arrived_at(connection: HTTPConnection) -> int:
    """Return when a request or WebSocket arrived, in the order of all that is asked."""
    return number_of(connection.scope)


def number_of(scope: Scope) -> int:
    """Return the same of a request's or WebSocket's scope."""
    arrived: int = scope[_REQUEST_NUMBER]
    return arrived


def decided_at(scope: Scope) -> int:
    """Return when what a request asks for was decided: as it arrived, or when its sender last heard of the device."""
    told = [int(stops) for stops in Headers(scope=scope).getlist(STOPS_HEADER) if _is_number(stops)]
    return min([number_of(scope), *told])


def as_old_as(scope: Scope, request_number: int) -> Scope:
    """Return a request's scope as one that was asked for then, unless it is older."""
    return {**scope, _REQUEST_NUMBER: min(number_of(scope), request_number)}


def _is_number(stops: str) -> bool:
    return stops.isascii() and stops.isdigit() and len(stops) <= MOST_DIGITS


RequestNumber = Annotated[int, Depends(latest_known_number)]
