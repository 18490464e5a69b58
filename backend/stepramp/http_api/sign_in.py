"""The way in for who is asked for a token: the link with it, a form, or what a program sends with each request."""

import re
from html import escape
from http import HTTPStatus
from urllib.parse import parse_qs, urlencode

from starlette.datastructures import Headers
from starlette.responses import HTMLResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send

from stepramp.errors import Forbidden, Unauthorized
from stepramp.http_api.access import CLIENT, MOST_TOKEN, Access, Client, Role, cookie_of
from stepramp.http_api.door import is_stop
from stepramp.http_api.errors import error_response
from stepramp.http_api.turned_away import TurnedAway

PARAMETER = "token"
HEALTH = "/api/v1/health"
"""What anybody may ask, as what keeps a container running does."""
NOT_KNOWN = (
    "This server wants a token: the link that it printed when it was started has it. Programs send the header "
    "Authorization: Bearer, and the token."
)
WRONG = "That is no token of this server, or of an earlier start of it."
LOOKS_ON = (
    "Your role is 'view'; allowed: to look on, to compute and to stop. To connect, push and move takes 'operate'."
)
ACTS = re.compile(r"/api/v1/(devices|ports|library)(/|$)")
"""Where what changes something for others is asked for; all else that isn't reading only computes."""
ONLY_TOLD = re.compile(r"/api/v1/(devices/[^/]+/push/preview|library/search|library/pushes/search)")
"""Where it is only told what would be changed."""
READS = ("GET", "HEAD", "OPTIONS")
EVENTS = "/api/v1/devices/events"
"""The WebSocket of who only listens, or stops."""

# The form asks for the same address with the token, which is taken out of it again at once. One that is posted would
# come with the Origin "null", as our pages send no referrer.
_PAGE = """<!doctype html>
<html lang="en">
<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>StepRamp: token</title>
<style>
:root {{ color-scheme: light dark; font: 15px/1.5 system-ui, sans-serif; }}
body {{ max-width: 26rem; margin: 15vh auto; padding: 0 1rem; }}
h1 {{ font-size: 1.2rem; }}
input, button {{ font: inherit; padding: .5rem .7rem; box-sizing: border-box; }}
input {{ width: 100%; margin: .3rem 0 .8rem; }}
.told {{ font-weight: 600; }}
</style>
<main>
<h1>StepRamp</h1>
<p class="told" role="alert">{told}</p>
<p>The link with the token was printed where this server was started. It can also be typed in here.</p>
<form>
<label>Token <input name="token" type="password" autocomplete="off" required autofocus></label>
<button>Go on</button>
</form>
</main>
</html>
"""


class SignIn:
    """Middleware, in the server's loop: lets in who is known, to what their role allows; shows others the way in."""

    def __init__(self, app: ASGIApp, access: Access) -> None:
        self._app = app
        self._access = access
        self._turned_away = TurnedAway()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what somebody may ask for, or answer with 401 or 403."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
        elif (response := self._answer_of_its_own(scope)) is not None:
            await response(scope, receive, send)
        else:
            await self._app(scope, receive, send)

    def _answer_of_its_own(self, scope: Scope) -> Response | None:
        if (token := _shown_token(scope)) is not None:
            return self._begin(scope, token)
        client = self._access.client_of(scope)
        if client is None and scope["path"] == HEALTH:
            return None
        if client is None:
            if _wants_a_page(scope):
                return _form("")
            self._turned_away.note(scope)
            return _unauthorized()
        # Also of who is refused: what was tried is noted with who has.
        scope[CLIENT] = client
        return error_response(Forbidden(LOOKS_ON)) if client.role is not Role.OPERATE and acts(scope) else None

    def _begin(self, scope: Scope, token: str) -> Response:
        role = self._access.role_of(token)
        if role is None:
            self._turned_away.note(scope)
            return _form(WRONG)
        # Without the token: else it would stand in the browser's history, and be copied with the address.
        response = RedirectResponse(_without_token(scope), status_code=303, headers={"cache-control": "no-store"})
        known = self._access.browser_of(scope)
        if known is not None and known.role in (role, Role.OPERATE):
            # A link to look on, wherever it was found, takes nothing from who operates.
            return response
        session = self._access.begin_session(role)
        is_secure = self._access.is_reached_over_tls
        response.set_cookie(cookie_of(scope), session, httponly=True, samesite="lax", secure=is_secure, path="/")
        return response


def acts(scope: Scope) -> bool:
    """Tell whether something is asked for that changes anything for others; a stop counts as none."""
    if ACTS.match(scope["path"]) is None or ONLY_TOLD.fullmatch(scope["path"]) or is_stop(scope):
        return False
    return bool(scope["path"] != EVENTS if scope["type"] == "websocket" else scope["method"] not in READS)


def client_of(scope: Scope) -> Client | None:
    """Return who sends a request, as far as that has to be known."""
    client: Client | None = scope.get(CLIENT)
    return client


def _shown_token(scope: Scope) -> str | None:
    """Return the token of a link, or of the form; None where none is shown."""
    if scope["type"] != "http" or scope["method"] != "GET" or scope["path"].startswith("/api/"):
        return None
    try:
        values = parse_qs(scope["query_string"].decode("ascii", "replace"), max_num_fields=20).get(PARAMETER)
    except ValueError:
        return None
    return None if values is None else values[0][: MOST_TOKEN + 1]


def _without_token(scope: Scope) -> str:
    """Return where a link leads without its token, on this server only."""
    fields = parse_qs(scope["query_string"].decode("ascii", "replace"), keep_blank_values=True)
    fields.pop(PARAMETER, None)
    query = urlencode(fields, doseq=True)
    # One slash: what begins with two is another server.
    path = "/" + scope["path"].lstrip("/\\")
    return f"{path}?{query}" if query else path


def _wants_a_page(scope: Scope) -> bool:
    if scope["type"] != "http" or scope["path"].startswith("/api/") or scope["method"] not in ("GET", "HEAD"):
        return False
    return "text/html" in Headers(scope=scope).get("accept", "")


def _form(told: str) -> Response:
    page = _PAGE.format(told=escape(told))
    return HTMLResponse(page, HTTPStatus.UNAUTHORIZED, headers={"cache-control": "no-store"})


def _unauthorized() -> Response:
    response = error_response(Unauthorized(NOT_KNOWN))
    response.headers["www-authenticate"] = 'Bearer realm="StepRamp"'
    return response
