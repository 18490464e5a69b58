"""Routes over the library as one file."""

import asyncio
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any, BinaryIO

from fastapi import APIRouter, Request
from starlette.responses import StreamingResponse
from starlette.types import Message, Receive, Scope, Send

from stepramp.errors import Unavailable
from stepramp.http_api.bodies import (
    FILE_TYPE,
    MOST_LIBRARY_BYTES,
    LibraryFileRoute,
    of_files,
    take_room,
    write_library_body,
)
from stepramp.http_api.lanes import LIBRARY_FILES
from stepramp.http_api.library_models import ImportedAnswer
from stepramp.http_api.planned import STALLED_S
from stepramp.library.whole import Whole

router = APIRouter(prefix="/library", tags=["library"], route_class=LibraryFileRoute)

NAME = "stepramp-library.jsonl"
PIECE_BYTES = 65_536
_FILE: dict[str, Any] = {
    "required": True,
    "description": f"The file, of up to {MOST_LIBRARY_BYTES:,} bytes",
    "content": {FILE_TYPE: {"schema": {"type": "string", "format": "binary"}}},
}
_AS_FILE: dict[int | str, dict[str, Any]] = {
    200: {"description": "Lines of JSON", "content": {FILE_TYPE: {"schema": {"type": "string", "format": "binary"}}}}
}


def _whole(request: Request) -> Whole:
    whole: Whole = request.app.state.whole_library
    return whole


class _Copy(StreamingResponse):
    """Sends a file without a name, which is gone once it is closed: however this or the server ends, nothing stays."""

    def __init__(self, file: BinaryIO) -> None:
        size = file.tell()
        file.seek(0)
        self._file = file
        headers = {"content-length": str(size), "content-disposition": f'attachment; filename="{NAME}"'}
        super().__init__(iter(partial(file.read, PIECE_BYTES), b""), headers=headers, media_type=FILE_TYPE)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def unless_stalled(message: Message) -> None:
            async with asyncio.timeout(STALLED_S):
                await send(message)

        with self._file:
            await super().__call__(scope, receive, unless_stalled)


@router.get("/file", response_class=StreamingResponse, responses=_AS_FILE)
async def library_as_file(request: Request) -> StreamingResponse:
    """Return all of the library as one file: designs with revisions and records, devices, and pushes."""
    with _roomless():
        file: BinaryIO = tempfile.TemporaryFile()  # noqa: SIM115  # closed once it is sent
        try:
            await LIBRARY_FILES.run(lambda: file.writelines(_whole(request).lines()))
            take_room(request, file.tell())
        except BaseException:
            file.close()  # Also when whoever asked has gone: the writing ends by it.
            raise
    return _Copy(file)


@router.post("/import", responses=of_files(MOST_LIBRARY_BYTES), openapi_extra={"requestBody": _FILE})
async def add_file(request: Request) -> ImportedAnswer:
    """Add what such a file has and the library hasn't: all of it, or, where something of it can't be, nothing.

    Nothing is overwritten: a design that has gone another way in the library is added beside it.
    """
    with _roomless(), tempfile.TemporaryFile() as file:
        await write_library_body(request, file)
        return await LIBRARY_FILES.run(partial(_added, _whole(request), file))


def _added(whole: Whole, file: BinaryIO) -> ImportedAnswer:
    return ImportedAnswer.model_validate(whole.add(file))


@contextmanager
def _roomless() -> Iterator[None]:
    """Have it said when there is no room for the file."""
    try:
        yield
    except OSError as error:
        folder = tempfile.gettempdir()
        raise Unavailable(
            f"The server can't keep the file while it is read or sent ({error.strerror}, in {folder}): nothing was "
            "changed. Make room, and ask again."
        ) from error
