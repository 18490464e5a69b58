"""Requests that are asked again with the same key: what they ask for is done once, and answered as it was."""

import asyncio
import hashlib
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from time import monotonic
from typing import TypeVar

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from stepramp.errors import Overloaded, Refused, Rejected, Rejection, StepRampError
from stepramp.http_api.access import Client
from stepramp.http_api.door import is_stop
from stepramp.http_api.errors import error_response
from stepramp.http_api.sign_in import acts, client_of

T = TypeVar("T")

KEY_HEADER = "Idempotency-Key"
REPLAYED_HEADER = "Idempotent-Replayed"
MOST_KEY = 200
"""Length of the longest key [characters]."""
MOST_KEPT = 1000
"""So many keys of each client are kept, the newest ones."""
KEPT_S = 24 * 3600.0
"""So long a key is kept [s]."""
MOST_ANSWER_BYTES = 500_000
"""Of a longer answer only that there was one is kept."""
MOST_TOGETHER_BYTES = 32_000_000
"""Nor more is kept of the oldest ones, where the answers of all clients are longer together."""
MOST_LEFT = 100
"""So many go on at a time whose clients have gone: they are counted nowhere else any more."""
TOO_MANY_LEFT = Overloaded(
    f"{MOST_LEFT} requests with keys are under way still whose clients have gone. Wait for what comes of them."
)
ALLOWED_KEY = f"1 to {MOST_KEY} visible ASCII characters, given once"
OTHER_REQUEST = "a key of its own for each request: this one was given for another one, by method, address or body"
NOT_KEPT = (
    "This was asked for before with the same key, and done; what came of it can't be told again. Look at the device."
)


@dataclass(eq=False)
class _Asked:
    """A request with a key, and what came of it."""

    request: tuple[str, str]
    ended: asyncio.Future[bool]
    """Whether it was done; False: it was refused, and may be asked again."""
    at_s: float
    body: str | None = None
    """Digest of its body, where that was read to its end."""
    answer: list[Message] = field(default_factory=list)
    """As it was sent, where it is kept."""

    @property
    def was_refused(self) -> bool:
        """Whether nothing was done."""
        return self.ended.done() and not self.ended.result()

    @property
    def size_bytes(self) -> int:
        """Size of the answer that is kept."""
        return sum(len(message.get("body", b"")) for message in self.answer)


class Idempotent:
    """Middleware for what changes something: a key in `Idempotency-Key` stands for one request of one client.

    Asked again with its key, a request waits for what came of the first one, and is answered the same. What was refused
    may be asked again, and is as old then as it was at first: see KeyAges. A request with a key is done though its
    client leaves. Stops take no key: each is a stop.
    """

    def __init__(self, app: ASGIApp, now_s: Callable[[], float] = monotonic) -> None:
        self._app = app
        self._now_s = now_s
        self._asked: dict[Client | None, OrderedDict[str, _Asked]] = {}
        """By client and key, the newest last."""
        self._answered: OrderedDict[_Asked, None] = OrderedDict()
        """Those of which the answer is kept."""
        self._answers_bytes = 0
        self._left: set[asyncio.Future[list[Message]]] = set()
        """What goes on though who asked has gone."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what has no key, or one that is new; answer anything else."""
        keys = _keys_of(scope)
        if not keys:
            await self._app(scope, receive, send)
        elif (key := key_of(scope)) is None:
            given = keys[0] if len(keys) == 1 else keys
            await error_response(Rejected([Rejection(KEY_HEADER, given, ALLOWED_KEY)]))(scope, receive, send)
        else:
            await self._once(key, scope, receive, send)

    async def _once(self, key: str, scope: Scope, receive: Receive, send: Send) -> None:
        self._forget()
        client = client_of(scope)
        request = (scope["method"], scope["raw_path"].decode("latin-1") + "?" + scope["query_string"].decode("latin-1"))
        while (before := keys_with(self._asked, key, client).get(key)) is not None and not before.was_refused:
            if before.request != request:
                await error_response(_of_another(key))(scope, receive, send)
                return
            if await asyncio.shield(before.ended):
                await _answer_again(before, key, scope, receive, send)
                return
        if len(self._left) >= MOST_LEFT:
            await error_response(TOO_MANY_LEFT)(scope, receive, send)
            return
        asked_before = keys_with(self._asked, key, client)
        asked_before.pop(key, None)
        asked = asked_before[key] = _Asked(request, asyncio.get_running_loop().create_future(), self._now_s())
        heard = _Hearing(receive)
        # It goes on when whoever asked leaves: asked again, it is told what came of it.
        doing = asyncio.ensure_future(self._do(asked, scope, heard))
        try:
            answer = await asyncio.shield(doing)
        except asyncio.CancelledError:
            heard.leave()
            self._left.add(doing)
            doing.add_done_callback(self._left.discard)
            raise
        for message in answer:
            await send(message)

    def _forget(self) -> None:
        """Forget what is too old, or too much of one client; what is under way stays."""
        since_s = self._now_s() - KEPT_S
        for client, asked in list(self._asked.items()):
            while (key := _oldest(asked)) is not None and (len(asked) > MOST_KEPT or asked[key].at_s < since_s):
                self._let_go(asked.pop(key))
            if not asked:
                del self._asked[client]

    def _keep(self, asked: _Asked, answer: list[Message]) -> None:
        """Keep an answer, in place of the oldest ones where it is too much."""
        asked.answer = answer
        if asked.size_bytes > MOST_ANSWER_BYTES:
            asked.answer = []
            return
        self._answered[asked] = None
        self._answers_bytes += asked.size_bytes
        while self._answers_bytes > MOST_TOGETHER_BYTES:
            self._let_go(next(iter(self._answered)))

    def _let_go(self, asked: _Asked) -> None:
        """Keep its answer no longer."""
        if asked in self._answered:
            del self._answered[asked]
            self._answers_bytes -= asked.size_bytes
            asked.answer = []

    async def _do(self, asked: _Asked, scope: Scope, heard: "_Hearing") -> list[Message]:
        """Have it done; return its answer."""
        answer: list[Message] = []

        async def send(message: Message) -> None:
            answer.append(message)

        is_done = True  # Whatever goes wrong, unless it is known that nothing was done.
        try:
            await self._app(scope, heard.receive, send)
            is_done = not _is_refusal(answer)
            if is_done:
                self._keep(asked, answer)
        finally:
            asked.body = heard.digest
            asked.ended.set_result(is_done)
        return answer


class _Hearing:
    """Reads a request's body for who serves it, and what it was."""

    def __init__(self, receive: Receive) -> None:
        self._receive = receive
        self._hash = hashlib.sha256()
        self._left = asyncio.Event()
        self.digest: str | None = None
        """Of the body, once all of it was read."""

    def leave(self) -> None:
        """Note that the client has gone: nothing more comes."""
        self._left.set()

    async def receive(self) -> Message:
        """Return the next message, as the server's own does."""
        receiving, leaving = asyncio.ensure_future(self._receive()), asyncio.ensure_future(self._left.wait())
        try:
            await asyncio.wait([receiving, leaving], return_when=asyncio.FIRST_COMPLETED)
            if not receiving.done():
                return {"type": "http.disconnect"}
            message = receiving.result()
        finally:
            receiving.cancel()
            leaving.cancel()
        if message["type"] == "http.request":
            self._hash.update(message.get("body", b""))
            if not message.get("more_body", False):
                self.digest = self._hash.hexdigest()
        return message

    async def read(self) -> str | None:
        """Read all of it; return its digest, None when the client has gone."""
        while self.digest is None and (await self.receive())["type"] == "http.request":
            pass
        return self.digest


def key_of(scope: Scope) -> str | None:
    """Return the key of a request that changes something; None where it has none, or none that can be used."""
    keys = _keys_of(scope)
    return keys[0] if len(keys) == 1 and _is_key(keys[0]) else None


def keys_with(kept: dict[Client | None, OrderedDict[str, T]], key: str, client: Client | None) -> OrderedDict[str, T]:
    """Return the keys among which one is that was given with the same token or session; else those of the client.

    Whoever asks again may do so from another address.
    """
    holder = None if client is None else client.holder
    of_holder = (keys for each, keys in kept.items() if (None if each is None else each.holder) == holder)
    found = next((keys for keys in of_holder if key in keys), None)
    return kept.setdefault(client, OrderedDict()) if found is None else found


def _keys_of(scope: Scope) -> list[str]:
    if scope["type"] != "http" or not acts(scope) or is_stop(scope):
        return []
    return Headers(scope=scope).getlist(KEY_HEADER)


def _oldest(asked: OrderedDict[str, _Asked]) -> str | None:
    """Return the key that was given first of those with which nothing is under way."""
    return next((key for key, each in asked.items() if each.ended.done()), None)


def _is_refusal(answer: list[Message]) -> bool:
    """Tell whether an answer says that nothing was done. 502 doesn't: nobody knows what a lost device has done."""
    status = answer[0]["status"] if answer else 500
    return 400 <= status < 500 or status == 503


async def _answer_again(before: _Asked, key: str, scope: Scope, receive: Receive, send: Send) -> None:
    body = await _Hearing(receive).read()
    if before.body is not None and body is not None and body != before.body:
        await error_response(_of_another(key))(scope, receive, send)
        return
    if not before.answer:
        await error_response(Refused(NOT_KEPT))(scope, receive, send)
        return
    start = {**before.answer[0], "headers": list(before.answer[0]["headers"])}
    MutableHeaders(scope=start)[REPLAYED_HEADER] = "true"
    for message in (start, *before.answer[1:]):
        await send(message)


def _of_another(key: str) -> StepRampError:
    return Rejected([Rejection(KEY_HEADER, key, OTHER_REQUEST)])


def _is_key(text: str) -> bool:
    return 0 < len(text) <= MOST_KEY and text.isascii() and text.isprintable() and " " not in text
