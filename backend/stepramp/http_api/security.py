"""Who may talk to the server: its own pages and programs, so that no foreign page can move a motor.

A page from elsewhere that a browser here has open can send requests to 127.0.0.1. Its Origin header gives it away, and
where there is none, what the browser says of the site in Sec-Fetch-Site; so does the Host header when it came through a
host name of its own that was pointed at 127.0.0.1 (DNS rebinding).
"""

import re

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from stepramp.errors import Forbidden, shown
from stepramp.http_api.errors import error_response

HOSTS = "localhost, 127.0.0.1 or [::1], and its port"
OWN_SITES = ("same-origin", "none")
"""What Sec-Fetch-Site says of our own pages, and of what somebody types into the browser."""

POLICY = (
    "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
    "connect-src 'self' ws: wss:; frame-ancestors 'none'"
)
"""Pages load nothing from elsewhere. Plotly and the API's pages style elements from scripts, hence unsafe-inline."""
HELP = "/help"
"""Where the documentation is: its pages have scripts within them, and nothing that anybody else has written."""
HELP_POLICY = POLICY.replace("default-src 'self';", "default-src 'self'; script-src 'self' 'unsafe-inline';")
ON_EVERY_ANSWER = (
    (b"x-content-type-options", b"nosniff"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"referrer-policy", b"no-referrer"),
)

_HOST = re.compile(r"(localhost|127\.0\.0\.1|\[::1\])(:(?P<port>[0-9]{1,5}))?", re.IGNORECASE)
_ANY_HOST = re.compile(
    r"([a-z0-9_]([a-z0-9_.-]{0,250}[a-z0-9_])?|\[[0-9a-f:.]{2,45}\])(:(?P<port>[0-9]{1,5}))?", re.IGNORECASE
)
_STARTS = ("http.response.start", "websocket.http.response.start")


class OwnPagesOnly:
    """Refuses every request and WebSocket that a page from elsewhere sends, or that names a host that isn't ours.

    scheme: how the server's own address begins. is_named_at_will: by any name of a host, as who asks has to be known
    anyway; else by those of the loopback only. public_url: of a proxy in front of it, whose pages are ours. host: the
    server's own address, which is one of the hosts.
    """

    def __init__(
        self,
        app: ASGIApp,
        *,
        scheme: str = "http",
        is_named_at_will: bool = False,
        public_url: str | None = None,
        host: str = "127.0.0.1",
    ) -> None:
        self.app = app
        self._scheme = scheme
        self._public_url = public_url
        own = re.compile(rf"({re.escape(host)})(:(?P<port>[0-9]{{1,5}}))?")
        self._hosts = (_ANY_HOST,) if is_named_at_will else (_HOST, own)
        is_other = _HOST.fullmatch(host) is None
        self._allowed = "the name of one host" if is_named_at_will else f"{host}, {HOSTS}" if is_other else HOSTS

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, or refuse it with status 403."""
        reason = self._refusal(scope) if scope["type"] in ("http", "websocket") else None
        if reason is None:
            await self.app(scope, receive, send)
        else:
            await error_response(Forbidden(reason))(scope, receive, send)

    def _refusal(self, scope: Scope) -> str | None:
        """Return why a request is refused, None if it isn't."""
        headers = Headers(scope=scope)
        hosts, origins, sites = (headers.getlist(name) for name in ("host", "origin", "sec-fetch-site"))
        if len(hosts) != 1 or not any(_is_host(kind, hosts[0]) for kind in self._hosts):
            return f"The Host header is {_told(hosts)}; allowed: {self._allowed}."
        own = self._own_origins(hosts[0].lower())
        if origins and [origin.lower() for origin in origins] not in [[each] for each in own]:
            return f"The Origin header is {_told(origins)}; allowed: {' or '.join(own)}, or none."
        if any(site not in OWN_SITES for site in sites) and not _opens_a_page(scope, headers):
            return f"The Sec-Fetch-Site header is {_told(sites)}; allowed: {' or '.join(OWN_SITES)}."
        return None

    def _own_origins(self, host: str) -> list[str]:
        """Return where our pages come from. A proxy may pass the name on that it is asked by, or name us by our own."""
        if self._public_url is None:
            return [f"{self._scheme}://{host}"]
        is_passed_on = host == self._public_url.partition("://")[2]
        return [self._public_url] if is_passed_on else [f"{self._scheme}://{host}", self._public_url]


def with_policy(scope: Scope, send: Send) -> Send:
    """Return what sends answers with the headers that tell a browser to keep them to ourselves."""
    is_of_help = str(scope.get("path", "")).startswith(f"{HELP}/")
    policy = (b"content-security-policy", (HELP_POLICY if is_of_help else POLICY).encode())

    async def guarded(message: Message) -> None:
        if message["type"] in _STARTS:
            message["headers"] = [*message.get("headers", ()), policy, *ON_EVERY_ANSWER]
        await send(message)

    return guarded


def _is_host(kind: re.Pattern[str], host: str) -> bool:
    match = kind.fullmatch(host)
    return match is not None and (match["port"] is None or 1 <= int(match["port"]) <= 65535)


def _opens_a_page(scope: Scope, headers: Headers) -> bool:
    """Tell whether a link was followed to one of our pages: a design may travel in it, and the page does nothing."""
    asked = scope.get("method"), headers.getlist("sec-fetch-mode"), headers.getlist("sec-fetch-dest")
    return asked == ("GET", ["navigate"], ["document"]) and not scope["path"].startswith("/api/")


def _told(values: list[str]) -> str:
    return ", ".join(map(shown, values)) or "missing"
