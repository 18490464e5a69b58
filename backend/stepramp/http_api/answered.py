"""The moment at which a stop is answered: what has come in by then was asked before, whether or not it was read.

The system may give a busy machine to others between the server's last look at what has come in and the writing of an
answer. So whoever's request waits to be read right after it was written is as old as the stop.
"""

from collections.abc import Callable

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from stepramp.http_api.connections import Connections
from stepramp.http_api.door import is_last, is_stop
from stepramp.http_api.request_numbers import number_of

AT_LAST = "stepramp.at_last"
"""In a message to a WebSocket, instead of its text: what makes the text as it is written, and has stops overtake what
was asked by then."""


class Answered:
    """Middleware, in the server's loop: sees to what has come in unread when a stop's answer is written.

    now: returns the number of the present moment in the order of all that is asked and stopped.
    """

    def __init__(self, app: ASGIApp, now: Callable[[], int], connections: Connections) -> None:
        self._app = app
        self._now = now
        self._connections = connections

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve a request, a WebSocket, or the application's beginning and end."""

        async def answer(message: Message) -> None:
            await send(message)
            if is_last(message):
                self._connections.make_unread_as_old_as(number_of(scope), but=scope.get("client"))

        async def tell(message: Message) -> None:
            if AT_LAST not in message:
                await send(message)
                return
            before = self._now()
            await send({"type": message["type"], "text": message[AT_LAST]()})
            self._connections.make_unread_as_old_as(before)

        if scope["type"] == "websocket":
            await self._app(scope, receive, tell)
        else:
            await self._app(scope, receive, answer if is_stop(scope) else send)
