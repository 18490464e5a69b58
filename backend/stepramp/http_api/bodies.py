"""Bodies of requests: how large they may be, of which type, and how they become documents.

A large body is parsed and validated in a thread: both take so long that a STOP would wait for them.
"""

import json
import re
from collections.abc import Callable, Coroutine, Iterator
from contextlib import contextmanager
from functools import partial
from inspect import signature
from typing import Any, get_args, get_origin

from fastapi import Request
from fastapi.routing import APIRoute
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect
from starlette.responses import Response
from starlette.types import Receive, Scope, Send

from stepramp.errors import Overloaded, Rejected, Rejection, escaped, shown
from stepramp.http_api.errors import ErrorList, error_response
from stepramp.http_api.json_response import JsonResponse
from stepramp.http_api.lanes import CHECKING
from stepramp.http_api.planned import Planned
from stepramp.validation import Document

MOST_BYTES = 2_000_000
"""Size of the largest body, and of the largest message on a WebSocket [bytes]."""
LARGE_BYTES = 16_384
"""What is larger is parsed and validated in a thread [bytes]."""
MOST_TOGETHER_BYTES = 32_000_000
"""Size of all larger bodies together, of those that are coming in and of those that are not answered yet [bytes]."""
OF_BODIES: dict[int | str, dict[str, Any]] = {
    400: {"model": ErrorList, "description": "The body ended early"},
    413: {"model": ErrorList, "description": f"The body is larger than {MOST_BYTES:,} bytes"},
    415: {"model": ErrorList, "description": "The body is not application/json"},
}
"""What is answered to a body that is not even looked at."""
WHOLE_TEXT = "text without halves of surrogate pairs"

_TAKE = "stepramp.take_room"
_ESCAPED_SURROGATE = re.compile(r"\\u[dD][89a-fA-F]")
_SURROGATE = re.compile("[\ud800-\udfff]")


class Room:
    """Memory for bodies, in one event loop. What is small always has room."""

    def __init__(self, most_bytes: int) -> None:
        self._left_bytes = most_bytes

    @contextmanager
    def held(self) -> Iterator[Callable[[int], None]]:
        """Yield what takes room for a body of so many bytes, or for more of it, until all is over.

        It raises Overloaded when there is none.
        """
        taken_bytes = 0

        def take(size_bytes: int) -> None:
            nonlocal taken_bytes
            if size_bytes <= LARGE_BYTES:
                return
            if size_bytes - taken_bytes > self._left_bytes:
                raise Overloaded("Too many large bodies are sent or planned at the same time. Ask again later.")
            self._left_bytes -= size_bytes - taken_bytes
            taken_bytes = size_bytes

        try:
            yield take
        finally:
            self._left_bytes += taken_bytes


class JsonRoute(APIRoute):
    """A route whose body, if it takes one, is a JSON document: refused before it is read when it can't be one.

    What it answers is described by what its endpoint returns, also when that is a response of an answer.
    """

    def __init__(self, path: str, endpoint: Callable[..., Any], **options: Any) -> None:
        returned = signature(endpoint).return_annotation
        if get_origin(returned) in (JsonResponse, Planned):
            [options["response_model"]] = get_args(returned)
        if _document_of(endpoint) is not None:
            options["responses"] = OF_BODIES | (options.get("responses") or {})
        super().__init__(path, endpoint, **options)

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve a request; its body has its room until the answer is sent, since what makes that needs it."""
        with _ROOM.held() as take:
            await super().handle({**scope, _TAKE: take}, receive, send)

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Return what handles a request: FastAPI's own handler, given the document in place of the body."""
        handle, kind = super().get_route_handler(), _document_of(self.endpoint)
        if kind is None:
            return handle

        def checked(body: bytes) -> Document:
            return kind.checked(_content(body))

        async def handle_document(request: Request) -> Response:
            _refuse_other_types(request)
            body = await read_body(request)
            try:
                is_large = len(body) > LARGE_BYTES
                document = await CHECKING.run(partial(checked, body)) if is_large else checked(body)
            except Rejected as error:
                return error_response(error)
            return await handle(_WithDocument(request, body, document))

        return handle_document


async def read_body(request: Request) -> bytes:
    """Return the body of a JsonRoute's request.

    Raises HTTPException with status 413 as soon as it is too large, without reading more, and 400 when it ends early;
    Overloaded when it has no room beside other large ones.
    """
    take_room: Callable[[int], None] = request.scope[_TAKE]
    declared = request.headers.get("content-length", "")
    chunks, size = [], int(declared) if declared.isdecimal() and len(declared) < 20 else 0
    try:
        if size <= MOST_BYTES:
            size = 0
            async for chunk in request.stream():
                chunks.append(chunk)
                size += len(chunk)
                if size > MOST_BYTES:
                    break
                take_room(size)
    except ClientDisconnect:
        raise HTTPException(400, "The request's body ended early.") from None
    if size > MOST_BYTES:
        raise HTTPException(413, f"The request's body is too large; allowed: up to {MOST_BYTES:,} bytes.")
    return b"".join(chunks)


def parsed_json(text: str) -> object:
    """Return JSON as objects; ValueError when it is none, is nested too deeply, or has numbers of too many digits.

    Raises Rejected for half a surrogate pair: UTF-8 can't carry it, so nothing that holds it could be answered.
    """
    try:
        content: object = json.loads(text)
    except RecursionError:
        raise ValueError("It is nested too deeply.") from None
    if _ESCAPED_SURROGATE.search(text) and (half := next(_halves(content), None)) is not None:
        path, value = half
        raise Rejected([Rejection(".".join(map(str, path)) or "document", value, WHOLE_TEXT)])
    return content


_ROOM = Room(MOST_TOGETHER_BYTES)


class _WithDocument(Request):
    """A request whose body has become a document already."""

    def __init__(self, request: Request, body: bytes, document: object) -> None:
        super().__init__(request.scope, request.receive)
        self._bytes, self._document = body, document

    async def body(self) -> bytes:
        return self._bytes

    async def json(self) -> object:
        return self._document


def _document_of(endpoint: Callable[..., Any]) -> type[Document] | None:
    """Return what an endpoint takes as its body, if it takes a document."""
    annotations = (parameter.annotation for parameter in signature(endpoint).parameters.values())
    return next((each for each in annotations if isinstance(each, type) and issubclass(each, Document)), None)


def _refuse_other_types(request: Request) -> None:
    given = request.headers.get("content-type")
    kind = (given or "").partition(";")[0].strip().lower()
    if kind != "application/json":
        raise HTTPException(415, f"The Content-Type header is {shown(given)}; allowed: application/json.")


def _content(body: bytes) -> object:
    try:
        return parsed_json(body.decode("utf-8-sig"))
    except Rejected:
        raise
    except ValueError as error:
        text = body[:1000].decode("utf-8", "backslashreplace")
        raise Rejected([Rejection("body", text, f"JSON ({error})")]) from None


def _halves(content: object) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Yield texts with half a surrogate pair, and where they are; of a field's name, where the field is."""
    waiting: list[tuple[tuple[str | int, ...], object]] = [((), content)]
    while waiting:
        path, value = waiting.pop()
        if isinstance(value, str) and _SURROGATE.search(value):
            yield path, value
        elif isinstance(value, list):
            waiting += [((*path, number), each) for number, each in enumerate(value)]
        elif isinstance(value, dict):
            names = list(map(escaped, value))
            yield from (((*path, name), name) for name, given in zip(names, value, strict=True) if name != given)
            waiting += [((*path, name), each) for name, each in zip(names, value.values(), strict=True)]
