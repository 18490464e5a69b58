"""Who may use the server from other machines: who has the token of a role, in a header or as a browser's cookie.

A server that listens on this machine only needs none of it: see security.
"""

import threading
from collections import OrderedDict
from collections.abc import Iterator, Mapping
from contextvars import ContextVar
from dataclasses import dataclass
from enum import StrEnum
from secrets import compare_digest, token_urlsafe
from typing import Self

from starlette.datastructures import Headers
from starlette.types import Scope

CLIENT = "stepramp.client"
"""In a scope: the Client who asks, where one has to be known."""
COOKIE = "stepramp-session"
"""Beginning of the cookie's name; the port follows, as browsers send a host's cookies to all of its ports."""
MOST_SESSIONS = 1000
"""So many browsers of a role are known at a time; who was heard of longest ago has to show the token again."""
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

    @property
    def holder(self) -> str:
        """What tells apart who has shown a token, from wherever: a browser, or all that send that of a role."""
        return f"{self.role} {self.session}".rstrip()


ASKING: ContextVar[Client | None] = ContextVar("ASKING", default=None)
"""Who asks what is being answered, where that has to be known."""


def cookie_of(scope: Scope) -> str:
    """Return the name of the cookie of the server that is asked."""
    server = scope.get("server") or ("", None)
    return f"{COOKIE}-{server[1]}"


class Access:
    """The tokens of the roles, and the browsers that have shown one. For any thread.

    is_encrypted: whether it is spoken to over TLS. public_url: how others reach it, through a proxy; without a slash at
    its end. None: where it listens.
    """

    def __init__(
        self, tokens: Mapping[Role, str], *, is_encrypted: bool = False, public_url: str | None = None
    ) -> None:
        self._tokens = dict(tokens)
        self._is_encrypted = is_encrypted
        self.public_url = public_url
        self._lock = threading.Lock()
        # By role: however many look on, who operates stays known.
        self._sessions: dict[Role, OrderedDict[str, None]] = {role: OrderedDict() for role in Role}

    @classmethod
    def with_new_tokens(cls, *, is_encrypted: bool = False, public_url: str | None = None) -> Self:
        """Return one whose tokens nobody knows yet."""
        tokens = {role: token_urlsafe(24) for role in Role}
        return cls(tokens, is_encrypted=is_encrypted, public_url=public_url)

    @property
    def scheme(self) -> str:
        """How addresses begin where the server listens."""
        return "https" if self._is_encrypted else "http"

    @property
    def is_reached_over_tls(self) -> bool:
        """Whether browsers speak to it, or to the proxy in front of it, over TLS."""
        return (self.public_url or f"{self.scheme}:").startswith("https:")

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
            self._sessions[role][session] = None
            while len(self._sessions[role]) > MOST_SESSIONS:
                self._sessions[role].popitem(last=False)
        return session

    def client_of(self, scope: Scope) -> Client | None:
        """Return who sends a request or opens a WebSocket; None for somebody without a token that counts."""
        scheme, _, token = Headers(scope=scope).get("authorization", "").partition(" ")
        if not scheme:
            return self.browser_of(scope)
        role = self.role_of(token.strip()) if scheme.lower() == "bearer" else None
        return None if role is None else Client(_place_of(scope), role)

    def browser_of(self, scope: Scope) -> Client | None:
        """Return whose browser sends a request, by its cookie; None for one that has not shown a token."""
        for session in _cookies(scope, cookie_of(scope)):
            with self._lock:
                role = next((role for role, sessions in self._sessions.items() if session in sessions), None)
                if role is not None:
                    self._sessions[role].move_to_end(session)
                    return Client(_place_of(scope), role, session[:6])
        return None


def _place_of(scope: Scope) -> str:
    return str((scope.get("client") or ("somewhere",))[0])


def _cookies(scope: Scope, name: str) -> Iterator[str]:
    """Yield the values of a cookie. Others, of whatever programs at the same host, may look as they like."""
    for text in Headers(scope=scope).getlist("cookie"):
        for cookie in text.split(";"):
            its_name, _, value = cookie.strip().partition("=")
            if its_name == name:
                yield value
