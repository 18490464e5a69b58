"""What one client may ask for, where several share a server: so often, and so much at the same time. Stops are free."""

import math
from collections import OrderedDict
from collections.abc import Callable
from time import monotonic

from starlette.types import ASGIApp, Receive, Scope, Send

from stepramp.errors import TooOften
from stepramp.http_api.access import ASKING, Role
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
OF_A_PLACE = 3
"""So many times as much all clients of a role at one address have together: a browser that shows its token again and
again is a new client each time. Behind a proxy all are at its address."""
MOST_REMEMBERED = 2000
"""So many shares are remembered; the one that was used longest ago is forgotten."""


class _Share:
    """What one client has used of its share, or all of a role at one address of theirs: so many times as much."""

    def __init__(self, times: int, now_s: float) -> None:
        self._times = times
        self._left, self._at_s = float(MOST_AT_ONCE * times), now_s
        self.open = {"http": 0, "websocket": 0}

    def refusal(self, kind: str, now_s: float) -> tuple[TooOften, float] | None:
        """Return why nothing more may be taken, and after how long it may [s]; None where it may."""
        most, what = (MOST_SERVED, "requests") if kind == "http" else (MOST_SOCKETS, "WebSockets")
        whose, who = ("of yours", "You ask") if self._times == 1 else ("at your address", "Those at your address ask")
        most *= self._times
        if self.open[kind] >= most:
            return TooOften(f"{most} {what} {whose} are open already. Close some, and ask again."), 1.0
        most_per_s = MOST_PER_S * self._times
        self._left = min(MOST_AT_ONCE * self._times, self._left + (now_s - self._at_s) * most_per_s)
        self._at_s = now_s
        if self._left < 1:
            wait_s = (1 - self._left) / most_per_s
            return TooOften(f"{who} more often than {most_per_s:g} times a second. Ask again later."), wait_s
        return None

    def begin(self, kind: str) -> None:
        """Take one request, which is open from now on."""
        self._left -= 1
        self.open[kind] += 1


class ClientLimits:
    """Middleware, in the server's loop: refuses with 429 what is more than a client's share, or its address's.

    Within the rest of the application ASKING tells who asks, for what limits itself. now_s: a clock [s].
    """

    def __init__(self, app: ASGIApp, now_s: Callable[[], float] = monotonic) -> None:
        self._app = app
        self._now_s = now_s
        self._shares: OrderedDict[tuple[str, Role, int], _Share] = OrderedDict()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve a request, a WebSocket, or the application's beginning and end."""
        client = client_of(scope)
        if client is None or is_stop(scope):
            await self._app(scope, receive, send)
            return
        now_s, kind = self._now_s(), scope["type"]
        whose = (client.name, client.role, 1), (client.place, client.role, OF_A_PLACE)
        shares = [self._share_of(each, now_s) for each in whose]
        refused = next(filter(None, (share.refusal(kind, now_s) for share in shares)), None)
        if refused is not None:
            error, wait_s = refused
            response = error_response(error)
            response.headers["retry-after"] = str(math.ceil(wait_s))
            await response(scope, receive, send)
            return
        for share in shares:
            share.begin(kind)
        token = ASKING.set(client)
        try:
            await self._app(scope, receive, send)
        finally:
            ASKING.reset(token)
            for share in shares:
                share.open[kind] -= 1

    def _share_of(self, whose: tuple[str, Role, int], now_s: float) -> _Share:
        share = self._shares.setdefault(whose, _Share(whose[2], now_s))
        self._shares.move_to_end(whose)
        idle = (name for name, each in self._shares.items() if not any(each.open.values()) and each is not share)
        while len(self._shares) > MOST_REMEMBERED and (name := next(idle, None)) is not None:
            del self._shares[name]
            idle = (name for name, each in self._shares.items() if not any(each.open.values()) and each is not share)
        return share
