"""What one client may ask for, where several share a server: so often, and so much at the same time. Stops are free."""

import math
from collections import OrderedDict
from collections.abc import Callable
from time import monotonic

from starlette.types import ASGIApp, Receive, Scope, Send

from stepramp.errors import TooOften
from stepramp.http_api.access import ASKING, Client
from stepramp.http_api.door import is_stop
from stepramp.http_api.errors import error_response
from stepramp.http_api.sign_in import client_of

MOST_PER_S = 50.0
"""So many requests a second one client may go on sending; a slider sends its questions over a socket."""
MOST_AT_ONCE = 400
"""So many may come at once after a pause: the page consists of 150 files."""
MOST_SERVED = 64
"""So many requests of one client are served at a time."""
MOST_SOCKETS = 24
"""So many WebSockets of one client are open at a time: a page has three."""
MOST_CLIENTS = 2000
"""So many are remembered; who was heard of longest ago is forgotten."""


class _Share:
    """What one client has used of its share."""

    def __init__(self, now_s: float) -> None:
        self._left, self._at_s = float(MOST_AT_ONCE), now_s
        self.open = {"http": 0, "websocket": 0}

    def takes_s(self, now_s: float) -> float:
        """Take one request; return 0, or after how long there is one to be taken [s]."""
        self._left = min(MOST_AT_ONCE, self._left + (now_s - self._at_s) * MOST_PER_S)
        self._at_s = now_s
        if self._left < 1:
            return (1 - self._left) / MOST_PER_S
        self._left -= 1
        return 0.0


class ClientLimits:
    """Middleware, in the server's loop: refuses with 429 what is more than a client's share.

    Within the rest of the application ASKING tells who asks, for what limits itself. now_s: a clock [s].
    """

    def __init__(self, app: ASGIApp, now_s: Callable[[], float] = monotonic) -> None:
        self._app = app
        self._now_s = now_s
        self._shares: OrderedDict[str, _Share] = OrderedDict()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve a request, a WebSocket, or the application's beginning and end."""
        client = client_of(scope)
        if client is None or is_stop(scope):
            await self._app(scope, receive, send)
            return
        share, kind = self._share_of(client), scope["type"]
        if (refused := self._refusal(share, kind)) is not None:
            error, wait_s = refused
            response = error_response(error)
            response.headers["retry-after"] = str(math.ceil(wait_s))
            await response(scope, receive, send)
            return
        share.open[kind] += 1
        token = ASKING.set(client)
        try:
            await self._app(scope, receive, send)
        finally:
            ASKING.reset(token)
            share.open[kind] -= 1

    def _refusal(self, share: _Share, kind: str) -> tuple[TooOften, float] | None:
        most, what = (MOST_SERVED, "requests") if kind == "http" else (MOST_SOCKETS, "WebSockets")
        if share.open[kind] >= most:
            return TooOften(f"{most} {what} of yours are open already. Close some, and ask again."), 1.0
        if wait_s := share.takes_s(self._now_s()):
            return TooOften(f"You ask more often than {MOST_PER_S:g} times a second. Ask again later."), wait_s
        return None

    def _share_of(self, client: Client) -> _Share:
        share = self._shares.setdefault(client.name, _Share(self._now_s()))
        self._shares.move_to_end(client.name)
        idle = (name for name, each in self._shares.items() if not any(each.open.values()) and each is not share)
        while len(self._shares) > MOST_CLIENTS and (name := next(idle, None)) is not None:
            del self._shares[name]
            idle = (name for name, each in self._shares.items() if not any(each.open.values()) and each is not share)
        return share
