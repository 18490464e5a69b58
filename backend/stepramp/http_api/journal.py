"""The journal: who asked what of devices, and what was answered, in the program's log."""

import logging
from time import monotonic
from urllib.parse import parse_qs

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from stepramp.errors import shown
from stepramp.http_api.sign_in import client_of

_logger = logging.getLogger(__name__)
_OF_DEVICES = "/api/v1/devices"
_STARTS = ("http.response.start", "websocket.http.response.start")


class Journal:
    """Middleware: tells of each request and WebSocket that acts on devices, once it has been answered or has ended."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass all of it on."""
        if not _logger.isEnabledFor(logging.INFO) or not _acts_on_devices(scope):
            await self._app(scope, receive, send)
            return
        began_s = monotonic()
        status = "not answered"

        async def told(message: Message) -> None:
            nonlocal status
            if message["type"] in _STARTS:
                status = str(message["status"])
            elif message["type"] == "websocket.accept":
                status = "ended"
            await send(message)

        try:
            await self._app(scope, receive, told)
        finally:
            passed_ms = (monotonic() - began_s) * 1000
            _logger.info("%s, asked for by %s: %s after %.0f ms", _what(scope), _who(scope), status, passed_ms)


def _acts_on_devices(scope: Scope) -> bool:
    acts = scope["type"] == "websocket" or (scope["type"] == "http" and scope["method"] not in ("GET", "HEAD"))
    return acts and str(scope["path"]).startswith(_OF_DEVICES)


def _what(scope: Scope) -> str:
    return f"{scope.get('method', 'WebSocket')} {scope.get('raw_path', b'').decode('ascii', 'replace')}"


def _who(scope: Scope) -> str:
    pages = parse_qs(scope["query_string"].decode("ascii", "replace")).get("page", [None])
    page = Headers(scope=scope).get("X-StepRamp-Page") or pages[0]
    asker = "a program" if page is None else f"page {shown(page)}"
    client = client_of(scope)
    return asker if client is None else f"{asker} at {client.name} ({client.role})"
