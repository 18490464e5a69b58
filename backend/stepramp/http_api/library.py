"""Routes over the library. Who changes a design says which version it is a change of: nobody's work is overwritten."""

import re
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Header, Path, Request

from stepramp.errors import Rejected, Rejection
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.error_items import ErrorList
from stepramp.http_api.json_response import JsonResponse
from stepramp.http_api.lanes import LIBRARY, LIBRARY_WRITING
from stepramp.http_api.library_models import (
    AboutPayload,
    ContentAnswer,
    DifferencesAnswer,
    DuplicatePayload,
    FoundAnswer,
    KeptAnswer,
    KeptWithRevisionsAnswer,
    NewDesignPayload,
    RecordAnswer,
    RecordContentAnswer,
    RecordPayload,
    RecordsAnswer,
    RevisionPayload,
    SearchPayload,
)
from stepramp.library.differences import differences
from stepramp.library.library import About, Kept, Library
from stepramp.library.records import Records

_OTHERS: dict[int | str, dict[str, Any]] = {
    404: {"model": ErrorList, "description": "There is no such design, or revision"},
    412: {"model": ErrorList, "description": "Somebody else changed the design meanwhile; nothing was overwritten"},
}

router = APIRouter(prefix="/library", tags=["library"], route_class=JsonRoute, responses=_OTHERS)


# Coroutines: a dependency that is none would wait for a thread of those that read the page's files.
async def _library(request: Request) -> Library:
    library: Library = request.app.state.library
    return library


async def _records(request: Request) -> Records:
    records: Records = request.app.state.records
    return records


async def _version(if_match: Annotated[str | None, Header(description="The ETag that the design had")] = None) -> int:
    """Return the version that a change is of; Rejected without one."""
    match = re.fullmatch(r'"([1-9][0-9]{0,9})"', if_match or "")
    if match is None:
        raise Rejected([Rejection("If-Match", if_match, 'the ETag of the design that the change is of, as "3"')])
    return int(match[1])


def _revision(field: str, text: str) -> int:
    if re.fullmatch(r"[1-9][0-9]{0,99}", text) is None:
        raise Rejected([Rejection(field, text, "the number of a revision, from 1 on")])
    return int(text)


_A_NUMBER = Path(description="Which revision, counted from 1", json_schema_extra={"type": "integer", "minimum": 1})


async def _number(number: Annotated[str, _A_NUMBER]) -> int:
    return _revision("number", number)


async def _other(other: Annotated[str, _A_NUMBER]) -> int:
    return _revision("other", other)


Number = Annotated[int, Depends(_number)]
Other = Annotated[int, Depends(_other)]
TheLibrary = Annotated[Library, Depends(_library)]
TheRecords = Annotated[Records, Depends(_records)]
Version = Annotated[int, Depends(_version)]


@router.post("/search")
@LIBRARY.serves
def search(request: SearchPayload, library: TheLibrary) -> FoundAnswer:
    """Search the designs; without words and tags all of them are found."""
    count, found = library.search(request.text, request.tags, request.first, request.most)
    return FoundAnswer.model_validate({"count": count, "designs": found})


@router.post("/designs")
@LIBRARY_WRITING.serves
def add(request: NewDesignPayload, library: TheLibrary) -> JsonResponse[KeptAnswer]:
    """Keep a design."""
    about = About(request.name or request.design.name, request.notes, request.tags)
    return _answer(library.add(request.design, about, request.note))


@router.get("/designs/{design_id}")
@LIBRARY.serves
def design(design_id: str, library: TheLibrary) -> JsonResponse[KeptWithRevisionsAnswer]:
    """Return what is known of a design, and of its revisions."""
    kept, history = library.get(design_id)
    answer = KeptWithRevisionsAnswer.model_validate(vars(kept) | {"history": history})
    return JsonResponse(answer, headers=_tag(kept))


@router.put("/designs/{design_id}")
@LIBRARY_WRITING.serves
def describe(design_id: str, request: AboutPayload, version: Version, library: TheLibrary) -> JsonResponse[KeptAnswer]:
    """Name a design anew, with its notes and tags."""
    return _answer(library.describe(design_id, version, About(request.name, request.notes, request.tags)))


@router.post("/designs/{design_id}/revisions")
@LIBRARY_WRITING.serves
def save(design_id: str, request: RevisionPayload, version: Version, library: TheLibrary) -> JsonResponse[KeptAnswer]:
    """Keep another revision; those before stay."""
    return _answer(library.save(design_id, version, request.design, request.note))


@router.get("/designs/{design_id}/revisions/{number}")
@LIBRARY.serves
def revision(design_id: str, number: Number, library: TheLibrary) -> ContentAnswer:
    """Return the design of a revision."""
    return ContentAnswer.model_validate({"number": number, "design": library.content(design_id, number)})


@router.get("/designs/{design_id}/revisions/{number}/differences/{other}")
@LIBRARY.serves
def compared(design_id: str, number: Number, other: Other, library: TheLibrary) -> DifferencesAnswer:
    """Return what a revision and another one differ in, field by field."""
    before, after = library.content(design_id, number), library.content(design_id, other)
    return DifferencesAnswer.model_validate({"differences": list(differences(before, after))})


@router.post("/designs/{design_id}/duplicate")
@LIBRARY_WRITING.serves
def duplicate(design_id: str, request: DuplicatePayload, library: TheLibrary) -> JsonResponse[KeptAnswer]:
    """Keep a copy of the newest revision as a design of its own."""
    return _answer(library.duplicate(design_id, request.name))


@router.post("/designs/{design_id}/records")
@LIBRARY_WRITING.serves
def keep_record(design_id: str, request: RecordPayload, records: TheRecords) -> RecordAnswer:
    """Keep a trace, a capture or a stall map with the revision that it is of."""
    record = records.add(design_id, request.revision, request.kind, request.document, request.note)
    return RecordAnswer.model_validate(record)


@router.get("/designs/{design_id}/records")
@LIBRARY.serves
def all_records(design_id: str, records: TheRecords) -> RecordsAnswer:
    """Return what was kept with a design."""
    return RecordsAnswer.model_validate({"records": records.all(design_id)})


@router.get("/designs/{design_id}/records/{record_id}")
@LIBRARY.serves
def record(design_id: str, record_id: str, records: TheRecords) -> RecordContentAnswer:
    """Return the document of what was kept."""
    return RecordContentAnswer.model_validate({"document": records.content(design_id, record_id)})


def _answer(kept: Kept) -> JsonResponse[KeptAnswer]:
    return JsonResponse(KeptAnswer.model_validate(kept), headers=_tag(kept))


def _tag(kept: Kept) -> dict[str, str]:
    return {"ETag": f'"{kept.version}"'}
