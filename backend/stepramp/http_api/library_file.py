"""Routes over the library as one file."""

import tempfile
from functools import partial
from pathlib import Path
from typing import Any

from fastapi import APIRouter, Request
from starlette.background import BackgroundTask
from starlette.responses import FileResponse

from stepramp.http_api.bodies import FILE_TYPE, MOST_FILE_BYTES, OF_FILES, FileRoute, read_file_body
from stepramp.http_api.lanes import LIBRARY
from stepramp.http_api.library_models import ImportedAnswer
from stepramp.library.whole import Whole

router = APIRouter(prefix="/library", tags=["library"], route_class=FileRoute)

NAME = "stepramp-library.jsonl"
_FILE: dict[str, Any] = {
    "required": True,
    "description": f"The file, of up to {MOST_FILE_BYTES:,} bytes",
    "content": {FILE_TYPE: {"schema": {"type": "string", "format": "binary"}}},
}
_AS_FILE: dict[int | str, dict[str, Any]] = {
    200: {"description": "Lines of JSON", "content": {FILE_TYPE: {"schema": {"type": "string", "format": "binary"}}}}
}


def _whole(request: Request) -> Whole:
    whole: Whole = request.app.state.whole_library
    return whole


@router.get("/file", response_class=FileResponse, responses=_AS_FILE)
async def library_as_file(request: Request) -> FileResponse:
    """Return all of the library as one file: designs with revisions and records, devices, and pushes."""
    file = await LIBRARY.run(partial(_written, _whole(request)))
    return FileResponse(file, filename=NAME, media_type=FILE_TYPE, background=BackgroundTask(file.unlink))


@router.post("/import", responses=OF_FILES, openapi_extra={"requestBody": _FILE})
async def add_file(request: Request) -> ImportedAnswer:
    """Add what such a file has and the library hasn't: all of it, or, where something of it can't be, nothing.

    Nothing is overwritten: a design that has gone another way in the library is added beside it.
    """
    parts = await read_file_body(request)
    return await LIBRARY.run(partial(_added, _whole(request), parts))


def _written(whole: Whole) -> Path:
    with tempfile.NamedTemporaryFile("wb", prefix="stepramp-", delete=False) as file:
        try:
            file.writelines(whole.lines())
        except BaseException:
            Path(file.name).unlink()
            raise
    return Path(file.name)


def _added(whole: Whole, parts: list[bytes]) -> ImportedAnswer:
    content = b"".join(parts)
    parts.clear()
    return ImportedAnswer.model_validate(whole.add(content))
