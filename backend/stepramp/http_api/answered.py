"""The moment at which a stop is answered: what has come in by then was asked before, whether or not it was read.

Until then nothing moves. It is the moment at which its answer is written, not that at which it is known: a client that
asks and doesn't read keeps it waiting. After a second of that its connection is cut: it was never answered.

The system may give a busy machine to others between the server's last look at what has come in and the writing of an
answer. So whoever's request waits to be read right after it was written is as old as the stop.
"""

from collections.abc import Callable
from contextlib import AbstractContextManager, ExitStack

from starlette.datastructures import MutableHeaders
from starlette.responses import Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from stepramp.http_api.answer import Answer
from stepramp.http_api.connections import Connections
from stepramp.http_api.door import is_last, is_stop
from stepramp.http_api.json_response import json_bytes
from stepramp.http_api.request_numbers import number_of

AT_LAST = "stepramp.at_last"
"""In a message, instead of its text or body: what makes that as it is written, and has stops overtake what was asked by
then."""
UNREAD_S = 1.0
"""So long a stop whose answer isn't read counts as unanswered, and lets nothing move [s]."""
_UNTIL_ANSWERED = "stepramp.until_answered"


def until_answered(scope: Scope, context: AbstractContextManager[None]) -> None:
    """Enter a context, as of a stop, and leave it as a request is answered, whatever comes of it."""
    stack: ExitStack = scope[_UNTIL_ANSWERED]
    stack.enter_context(context)


class LastResponse(Response):
    """A stop's answer, made in the instant at which it is written, after what holds until it is answered has ended."""

    def __init__(self, make: Callable[[], Answer]) -> None:
        super().__init__(media_type="application/json")
        self._make = make

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send it."""
        del scope, receive
        await send({"type": "http.response.start", "status": self.status_code, "headers": self.raw_headers})
        await send({"type": "http.response.body", AT_LAST: lambda: json_bytes(self._make())})


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

        async def tell(message: Message) -> None:
            if AT_LAST not in message:
                await send(message)
                return
            before = self._now()
            await send({"type": message["type"], "text": message[AT_LAST]()})
            self._connections.make_unread_as_old_as(before)

        if scope["type"] == "websocket":
            await self._app(scope, receive, tell)
        elif is_stop(scope):
            await self._serve_stop(scope, receive, send)
        else:
            await self._app(scope, receive, send)

    async def _serve_stop(self, scope: Scope, receive: Receive, send: Send) -> None:
        start: list[Message] = []

        async def answer(message: Message) -> None:
            if not is_last(message):
                start.append(message)
                return
            await self._connections.take_or_cut(scope.get("client"), UNREAD_S)
            # From here on nothing is waited for, and nothing else comes in, until all of it is written.
            until_then.close()
            for each in _made(start, message):
                await send(each)
            self._connections.make_unread_as_old_as(number_of(scope), but=scope.get("client"))

        with ExitStack() as until_then:
            await self._app({**scope, _UNTIL_ANSWERED: until_then}, receive, answer)


def _made(start: list[Message], last: Message) -> list[Message]:
    """Return the messages of an answer, with the body of one that is made at last."""
    if AT_LAST not in last:
        return [*start, last]
    body: bytes = last[AT_LAST]()
    headed: Message = {**start[0], "headers": list(start[0]["headers"])}
    MutableHeaders(scope=headed)["content-length"] = str(len(body))
    return [headed, *start[1:], {"type": last["type"], "body": body}]
