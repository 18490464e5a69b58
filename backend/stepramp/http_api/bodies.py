"""Bodies of requests: how large they may be, of which type, and how they become documents.

A large body is parsed and validated in a thread: both take so long that a STOP would wait for them.
"""

import asyncio
from collections import Counter
from collections.abc import AsyncIterator, Callable, Coroutine, Iterable, Iterator
from contextlib import contextmanager
from functools import partial
from inspect import signature
from typing import Any, BinaryIO, get_args, get_origin

from fastapi import Request
from fastapi.routing import APIRoute
from starlette.datastructures import Headers, QueryParams
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect
from starlette.responses import Response
from starlette.types import Receive, Scope, Send

from stepramp.errors import Overloaded, Rejected, Rejection, TooOften, UnsupportedMediaType, shown
from stepramp.http_api.access import ASKING
from stepramp.http_api.error_items import ErrorList
from stepramp.http_api.errors import error_response
from stepramp.http_api.json_response import JsonResponse
from stepramp.http_api.lanes import CHECKING
from stepramp.http_api.planned import Planned
from stepramp.json_text import ONCE, parsed_json, why_unreadable
from stepramp.validation import Document

MOST_BYTES = 2_000_000
"""Size of the largest body, and of the largest message on a WebSocket [bytes]."""
MOST_FILE_BYTES = 2**28
"""Size of the largest file [bytes]."""
MOST_TAKEN_BYTES = 2**30
"""So much of a file that is too large is taken before it is refused [bytes]."""
MOST_LIBRARY_BYTES = 2**31
"""Size of the largest file with a library: it is on the disk, not in memory [bytes]."""
WRITTEN_AT_ONCE_BYTES = 2**20
JSON_TYPE = "application/json"
JSON_CHARSETS = {"utf-8", "utf8", "us-ascii"}
"""What JSON may say that it is in: it is read as UTF-8, of which US-ASCII is a part."""
FILE_TYPE = "application/octet-stream"
LARGE_BYTES = 16_384
"""What is larger is parsed and validated in a thread [bytes]."""
MOST_TOGETHER_BYTES = 32_000_000
"""Size of all larger bodies together, of those that are coming in and of those that are not answered yet [bytes]."""


def of_files(most_bytes: int) -> dict[int | str, dict[str, Any]]:
    """Return what is answered to a file that is not even looked at."""
    return {
        400: {"model": ErrorList, "description": "The body ended early"},
        413: {"model": ErrorList, "description": f"The body is larger than {most_bytes:,} bytes"},
        415: {"model": ErrorList, "description": f"The body is not {FILE_TYPE}, or compressed"},
    }


OF_BODIES: dict[int | str, dict[str, Any]] = {
    400: {"model": ErrorList, "description": "The body ended early"},
    413: {"model": ErrorList, "description": f"The body is larger than {MOST_BYTES:,} bytes"},
    415: {"model": ErrorList, "description": "The body is not application/json in UTF-8, or compressed"},
}
"""What is answered to a body that is not even looked at."""

_TAKE = "stepramp.take_room"


class Room:
    """Memory for bodies, in one event loop. What is small always has room; one client has half of it at most."""

    def __init__(self, most_bytes: int) -> None:
        self._left_bytes = most_bytes
        self._most_of_a_client_bytes = most_bytes // 2
        self._of_clients: Counter[str] = Counter()

    @contextmanager
    def held(self) -> Iterator[Callable[[int], None]]:
        """Yield what takes room for a body of so many bytes, or for more of it, until all is over.

        It raises Overloaded when there is none, TooOften when one client has taken too much.
        """
        taken_bytes, asking = 0, ASKING.get()

        def take(size_bytes: int) -> None:
            nonlocal taken_bytes
            if size_bytes <= LARGE_BYTES:
                return
            more_bytes = size_bytes - taken_bytes
            if more_bytes > self._left_bytes:
                raise Overloaded("Too many large bodies are sent or planned at the same time. Ask again later.")
            if asking is not None:
                if self._of_clients[asking.name] + more_bytes > self._most_of_a_client_bytes:
                    raise TooOften("You send too many large bodies at the same time. Ask again later.")
                self._of_clients[asking.name] += more_bytes
            self._left_bytes -= more_bytes
            taken_bytes = size_bytes

        try:
            yield take
        finally:
            self._left_bytes += taken_bytes
            if asking is not None:
                self._of_clients[asking.name] -= taken_bytes
                self._of_clients += Counter()  # Only those above zero stay.


class JsonRoute(APIRoute):
    """A route whose body, if it takes one, is a JSON document: refused before it is read when it can't be one.

    What it answers is described by what its endpoint returns, also when that is a response of an answer.
    """

    room = Room(MOST_TOGETHER_BYTES)
    """For all such routes together."""

    def __init__(self, path: str, endpoint: Callable[..., Any], **options: Any) -> None:
        returned = signature(endpoint).return_annotation
        if get_origin(returned) in (JsonResponse, Planned):
            [options["response_model"]] = get_args(returned)
        if _document_of(endpoint) is not None:
            options["responses"] = OF_BODIES | (options.get("responses") or {})
        super().__init__(path, endpoint, **options)

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve a request; its body has its room until the answer is sent, since what makes that needs it."""
        with self.room.held() as take:
            await super().handle({**scope, _TAKE: take}, receive, send)

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """Return what handles a request: FastAPI's own handler, given the document in place of the body."""
        handle, kind = super().get_route_handler(), _document_of(self.endpoint)
        parameters = [each.alias for each in self.dependant.query_params]
        if kind is None:
            assert not parameters, "who takes parameters without a document has to refuse repeated ones"
            return handle

        def checked(body: bytes) -> Document:
            return kind.checked(_content(body))

        async def handle_document(request: Request) -> Response:
            _refuse_other_types(request, JSON_TYPE)
            _refuse_encodings(request)
            body = await read_body(request)
            try:
                refuse_repeated(request.query_params, parameters)
                is_large = len(body) > LARGE_BYTES
                document = await CHECKING.run(partial(checked, body)) if is_large else checked(body)
            except Rejected as error:
                return error_response(error)
            return await handle(_WithDocument(request, body, document))

        return handle_document


class FileRoute(JsonRoute):
    """A route whose body is a file, in memory."""

    room = Room(2 * MOST_FILE_BYTES)


class LibraryFileRoute(JsonRoute):
    """A route whose body, or answer, is a file with a library, on the disk."""

    room = Room(2 * MOST_LIBRARY_BYTES)


def take_room(request: Request, size_bytes: int) -> None:
    """Take room until a JsonRoute's request is answered: for its body, or its answer, of so many bytes.

    Raises Overloaded or TooOften where there is none.
    """
    take: Callable[[int], None] = request.scope[_TAKE]
    take(size_bytes)


def refuse_repeated(given: QueryParams | Headers, names: Iterable[str]) -> None:
    """Raise Rejected for parameters or headers of these names that are given more than once."""
    repeated = [Rejection(name, values, ONCE) for name in names if len(values := given.getlist(name)) > 1]
    if repeated:
        raise Rejected(repeated)


async def read_body(request: Request) -> bytes:
    """Return the body of a JsonRoute's request; it raises what _parts_of raises."""
    return b"".join([part async for part in _parts_of(request, MOST_BYTES, MOST_BYTES)])


async def read_file_body(request: Request) -> list[bytes]:
    """Return the body of a FileRoute's request, in parts: to join them takes long.

    Raises UnsupportedMediaType for another type or a compressed body, and what _parts_of raises. Most of a
    body that is too large is taken, though not kept: a browser shows no answer that comes before it has sent all.
    """
    _refuse_other_types(request, FILE_TYPE)
    _refuse_encodings(request)
    return [part async for part in _parts_of(request, MOST_FILE_BYTES, MOST_TAKEN_BYTES)]


async def write_library_body(request: Request, file: BinaryIO) -> None:
    """Write the body of a LibraryFileRoute's request into a file.

    Raises OSError where that can't be written, and else as read_file_body.
    """
    _refuse_other_types(request, FILE_TYPE)
    _refuse_encodings(request)
    parts: list[bytes] = []
    size = 0
    async for part in _parts_of(request, MOST_LIBRARY_BYTES, MOST_LIBRARY_BYTES + MOST_TAKEN_BYTES):
        parts.append(part)
        size += len(part)
        if size >= WRITTEN_AT_ONCE_BYTES:
            # In a thread: where the disk can't keep up, the system lets whoever writes wait.
            await asyncio.to_thread(file.writelines, parts)
            parts, size = [], 0
    await asyncio.to_thread(file.writelines, parts)


async def _parts_of(request: Request, most_bytes: int, most_taken_bytes: int) -> AsyncIterator[bytes]:
    """Yield a body in parts.

    Raises HTTPException with status 413 when it is too large, without reading more than is to be taken, and 400 when it
    ends early; Overloaded when it has no room beside other large ones.
    """
    declared = request.headers.get("content-length", "")
    size = int(declared) if declared.isdecimal() and len(declared) < 20 else 0
    try:
        if size <= most_taken_bytes:
            size = 0
            async for part in request.stream():
                size += len(part)
                if size > most_taken_bytes:
                    break
                if size <= most_bytes:
                    take_room(request, size)
                    yield part
    except ClientDisconnect:
        raise HTTPException(400, "The request's body ended early.") from None
    if size > most_bytes:
        raise HTTPException(413, f"The request's body is too large; allowed: up to {most_bytes:,} bytes.")


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


def _refuse_other_types(request: Request, allowed: str) -> None:
    given = request.headers.get("content-type")
    kind, *parameters = (given or "").lower().split(";")
    if kind.strip() != allowed:
        raise _unsupported("Content-Type", given, allowed)
    named = [each.partition("=") for each in parameters]
    charsets = {value.strip(' "') for name, _, value in named if name.strip() == "charset"}
    if allowed == JSON_TYPE and not charsets <= JSON_CHARSETS:
        words = f"{allowed} with charset utf-8 or us-ascii, or without one"
        raise _unsupported("Content-Type", given, words)


def _refuse_encodings(request: Request) -> None:
    """Raise UnsupportedMediaType for a body that is compressed: how large it becomes is known too late."""
    told = ", ".join(request.headers.getlist("content-encoding"))
    if not {each.strip().lower() for each in told.split(",")} <= {"", "identity"}:
        raise _unsupported("Content-Encoding", told, "identity, or none")


def _unsupported(header: str, given: str | None, allowed: str) -> UnsupportedMediaType:
    words = f"The {header} header is {shown(given)}; allowed: {allowed}."
    return UnsupportedMediaType([Rejection(header, given, allowed, reason=words)])


def _content(body: bytes) -> object:
    try:
        return parsed_json(body.decode("utf-8-sig"))
    except Rejected:
        raise
    except UnicodeDecodeError:
        shown_bytes = body[:100].decode("latin-1")
        raise Rejected([Rejection("body", shown_bytes, "JSON in UTF-8, not compressed")]) from None
    except ValueError as error:
        text = body[:1000].decode("utf-8", "backslashreplace")
        raise Rejected([Rejection("body", text, f"JSON ({why_unreadable(error)})")]) from None
