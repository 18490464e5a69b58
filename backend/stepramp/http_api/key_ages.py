"""How old a request with a key is: noted before anything may refuse it, so that a stop overtakes its repeats, too."""

from collections import OrderedDict
from collections.abc import Callable
from time import monotonic

from starlette.types import ASGIApp, Receive, Scope, Send

from stepramp.http_api.access import Client
from stepramp.http_api.idempotency import KEPT_S, MOST_KEPT, key_of, keys_with
from stepramp.http_api.request_numbers import as_old_as, decided_at
from stepramp.http_api.sign_in import client_of


class KeyAges:
    """Middleware, in the server's loop: what is asked again with its key is as old as it was at first.

    Whatever has refused it since: a client's share, too many requests at a time, or the device. Of each client the keys
    are remembered that were given last.
    """

    def __init__(self, app: ASGIApp, now_s: Callable[[], float] = monotonic) -> None:
        self._app = app
        self._now_s = now_s
        self._given: dict[Client | None, OrderedDict[str, tuple[int, float]]] = {}
        """By client and key: the number of the first request with it, and when it was given last [s]."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass all of it on."""
        key = key_of(scope)
        if key is not None:
            scope = as_old_as(scope, self._first_asked(key, scope))
        await self._app(scope, receive, send)

    def _first_asked(self, key: str, scope: Scope) -> int:
        """Return when a request with this key was decided first, and remember it."""
        now_s = self._now_s()
        self._forget_before(now_s - KEPT_S)
        given = keys_with(self._given, key, client_of(scope))
        decided = decided_at(scope)
        number = min(decided, given.pop(key, (decided, now_s))[0])
        given[key] = number, now_s
        if len(given) > MOST_KEPT:
            given.popitem(last=False)
        return number

    def _forget_before(self, since_s: float) -> None:
        for client, given in list(self._given.items()):
            while given and next(iter(given.values()))[1] < since_s:
                given.popitem(last=False)
            if not given:
                del self._given[client]
