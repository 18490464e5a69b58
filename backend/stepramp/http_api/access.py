"""Who may use the server from other machines: who has the token of a role, in a header or as a browser's cookie.

A server that listens on this machine only needs none of it: see security.
"""

import threading
from collections import OrderedDict
from collections.abc import Iterable, Mapping
from contextvars import ContextVar
from dataclasses import dataclass
from enum import StrEnum
from http.cookies import CookieError, SimpleCookie
from secrets import compare_digest, token_urlsafe
from typing import Self

from starlette.datastructures import Headers
from starlette.types import Scope

CLIENT = "stepramp.client"
"""In a scope: the Client who asks, where one has to be known."""
COOKIE = "stepramp-session"
"""Beginning of the cookie's name; the port follows, as browsers send a host's cookies to all of its ports."""
MOST_SESSIONS = 1000
"""So many browsers are known at a time; who was heard of longest ago has to show the token again."""
LEAST_TOKEN, MOST_TOKEN = 16, 200
"""Lengths of a token [characters]."""


class Role(StrEnum):
    """What somebody may do."""

    VIEW = "view"
    """See everything, compute, and stop."""
    OPERATE = "operate"
    """Also connect, push and move."""


@dataclass(frozen=True)
class Client:
    """Somebody at another machine, or at this one."""

    place: str
    """Address of the machine where they are."""
    role: Role
    session: str = ""
    """Of a browser: what tells it apart from others there."""

    @property
    def name(self) -> str:
        """What tells them apart from all others."""
        return f"{self.place} {self.session}".rstrip()


ASKING: ContextVar[Client | None] = ContextVar("ASKING", default=None)
"""Who asks what is being answered, where that has to be known."""


def cookie_of(scope: Scope) -> str:
    """Return the name of the cookie of the server that is asked."""
    server = scope.get("server") or ("", None)
    return f"{COOKIE}-{server[1]}"


class Access:
    """The tokens of the roles, and the browsers that have shown one. For any thread.

    is_encrypted: whether it is spoken to over TLS.
    """

    def __init__(self, tokens: Mapping[Role, str], *, is_encrypted: bool = False) -> None:
        self._tokens = dict(tokens)
        self.is_encrypted = is_encrypted
        self._lock = threading.Lock()
        self._sessions: OrderedDict[str, Role] = OrderedDict()

    @classmethod
    def with_new_tokens(cls, *, is_encrypted: bool = False) -> Self:
        """Return one whose tokens nobody knows yet."""
        return cls({role: token_urlsafe(24) for role in Role}, is_encrypted=is_encrypted)

    @property
    def scheme(self) -> str:
        """How addresses of the server begin."""
        return "https" if self.is_encrypted else "http"

    def token_of(self, role: Role) -> str:
        """Return the token of a role."""
        return self._tokens[role]

    def role_of(self, token: str) -> Role | None:
        """Return whose token it is; None for nobody's."""
        given = token.encode()
        # All of them are compared, each in constant time: how long it takes tells nothing.
        roles = [role for role, own in self._tokens.items() if compare_digest(own.encode(), given)]
        return roles[0] if roles else None

    def begin_session(self, role: Role) -> str:
        """Return what a browser keeps in place of the token."""
        session = token_urlsafe(24)
        with self._lock:
            self._sessions[session] = role
            while len(self._sessions) > MOST_SESSIONS:
                self._sessions.popitem(last=False)
        return session

    def client_of(self, scope: Scope) -> Client | None:
        """Return who sends a request or opens a WebSocket; None for somebody without a token that counts."""
        headers = Headers(scope=scope)
        place = (scope.get("client") or ("somewhere",))[0]
        scheme, _, token = headers.get("authorization", "").partition(" ")
        if scheme:
            role = self.role_of(token.strip()) if scheme.lower() == "bearer" else None
            return None if role is None else Client(str(place), role)
        return next((each for each in self._known(headers.getlist("cookie"), cookie_of(scope), str(place))), None)

    def _known(self, cookies: Iterable[str], name: str, place: str) -> Iterable[Client]:
        for text in cookies:
            try:
                cookie = SimpleCookie(text)
            except CookieError:
                continue
            if name not in cookie:
                continue
            session = cookie[name].value
            with self._lock:
                role = self._sessions.get(session)
                if role is not None:
                    self._sessions.move_to_end(session)
                    yield Client(place, role, session[:6])
