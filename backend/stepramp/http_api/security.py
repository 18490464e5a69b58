"""Who may talk to the server: this machine's own pages and programs, so that no foreign page can move a motor.

A page from elsewhere that a browser here has open can send requests to 127.0.0.1. Its Origin header gives it away; so
does the Host header when it came through a host name of its own that was pointed at 127.0.0.1 (DNS rebinding).
"""

from urllib.parse import urlsplit

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from stepramp.errors import Forbidden
from stepramp.http_api.errors import error_response

LOOPBACK_NAMES = ("localhost", "127.0.0.1", "::1")

POLICY = (
    "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
    "connect-src 'self' ws:; frame-ancestors 'none'"
)
"""Pages load nothing from elsewhere. Plotly and the API's pages style elements from scripts, hence unsafe-inline."""


class LoopbackOnly:
    """Refuses every request and WebSocket that is not for this machine, or that a page from elsewhere sends."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or refuse it with status 403."""
        if scope["type"] not in ("http", "websocket"):
            await self.app(scope, receive, send)
            return
        reason = _refusal(Headers(scope=scope))
        if reason is None:
            await self.app(scope, receive, _with_policy(send))
        elif scope["type"] == "websocket":
            await receive()
            await send({"type": "websocket.close", "code": 1008, "reason": reason})
        else:
            await error_response(Forbidden(reason))(scope, receive, send)


def _refusal(headers: Headers) -> str | None:
    """Return why a request is refused, None if it isn't."""
    hosts, origins = headers.getlist("host"), headers.getlist("origin")
    if len(hosts) != 1 or _name(f"//{hosts[0]}") not in LOOPBACK_NAMES:
        return f"The Host header is {', '.join(hosts) or 'missing'}; allowed: {', '.join(LOOPBACK_NAMES)}."
    if origins and origins != [f"http://{hosts[0]}"]:
        return f"The Origin header is {', '.join(origins)}; allowed: http://{hosts[0]}, or none."
    return None


def _name(address: str) -> str | None:
    """Return an address's host name; None when it has none or its port is not a number."""
    try:
        parts = urlsplit(address)
        return parts.hostname if parts.path == "" and (parts.port is None or parts.port >= 0) else None
    except ValueError:
        return None


def _with_policy(send: Send) -> Send:
    async def guarded(message: Message) -> None:
        if message["type"] == "http.response.start":
            message["headers"] = [
                *message["headers"],
                (b"content-security-policy", POLICY.encode()),
                (b"x-content-type-options", b"nosniff"),
                (b"referrer-policy", b"no-referrer"),
            ]
        await send(message)

    return guarded
