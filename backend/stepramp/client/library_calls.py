"""What a client can ask of the library of designs."""

from collections.abc import Mapping, Sequence
from urllib.parse import quote

from stepramp.client.calls import QUICK_S, Call, get, payload, post
from stepramp.client.design_calls import ADesign
from stepramp.errors import NotFound, shown
from stepramp.http_api.answer import Answer
from stepramp.http_api.history_models import (
    PushedToWithDesignsAnswer,
    PushesAnswer,
    PushesPayload,
    SeenDevicesAnswer,
)
from stepramp.http_api.library_models import (
    AboutPayload,
    ContentAnswer,
    DifferencesAnswer,
    DuplicatePayload,
    FoundAnswer,
    ImportedAnswer,
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

_BUSY_S = 2 * QUICK_S
"""Another who writes is waited for."""
_WHOLE_S = 600.0
"""Of a whole library, which may have two gigabytes [s]."""


def search_designs(
    text: str = "", tags: Sequence[str] = (), *, first: int = 0, most: int | None = None
) -> Call[FoundAnswer]:
    """Search the library's designs; without words and tags all of them are found."""
    body = payload(SearchPayload, text=text, tags=list(tags), first=first, most=most)
    return post("library/search", FoundAnswer, body, patience_s=_BUSY_S)


def add_design(
    design: ADesign, *, name: str | None = None, notes: str = "", tags: Sequence[str] = (), note: str = ""
) -> Call[KeptAnswer]:
    """Keep a design in the library, as its revision 1."""
    body = payload(NewDesignPayload, design=design, name=name, notes=notes, tags=list(tags), note=note)
    return post("library/designs", KeptAnswer, body, patience_s=_BUSY_S)


def kept_design(design_id: str) -> Call[KeptWithRevisionsAnswer]:
    """Return what is known of a design of the library, and of its revisions."""
    return get(_path(design_id), KeptWithRevisionsAnswer, _BUSY_S)


def describe_design(
    design_id: str, version: int, name: str, *, notes: str = "", tags: Sequence[str] = ()
) -> Call[KeptAnswer]:
    """Name a design anew, with its notes and tags. version: the one that this is a change of."""
    body = payload(AboutPayload, name=name, notes=notes, tags=list(tags))
    return Call("PUT", _path(design_id), KeptAnswer.model_validate_json, body, headers=_of(version), patience_s=_BUSY_S)


def save_revision(design_id: str, version: int, design: ADesign, *, note: str = "") -> Call[KeptAnswer]:
    """Keep another revision of a design. version: the one that this is a change of."""
    body = payload(RevisionPayload, design=design, note=note)
    return post(_path(design_id, "/revisions"), KeptAnswer, body, headers=_of(version), patience_s=_BUSY_S)


def revision(design_id: str, number: int) -> Call[ContentAnswer]:
    """Return the design of a revision."""
    return get(_path(design_id, f"/revisions/{number}"), ContentAnswer, _BUSY_S)


def differences(design_id: str, number: int, other: int) -> Call[DifferencesAnswer]:
    """Return what two revisions differ in, field by field."""
    return get(_path(design_id, f"/revisions/{number}/differences/{other}"), DifferencesAnswer, _BUSY_S)


def duplicate_design(design_id: str, name: str) -> Call[KeptAnswer]:
    """Keep a copy of the newest revision as a design of its own."""
    body = payload(DuplicatePayload, name=name)
    return post(_path(design_id, "/duplicate"), KeptAnswer, body, patience_s=_BUSY_S)


def keep_record(
    design_id: str, revision: int, kind: str, document: Mapping[str, object] | Answer, *, note: str = ""
) -> Call[RecordAnswer]:
    """Keep a trace, a capture or a stall_map with the revision that it is of. document: as the API answered it."""
    told = document.model_dump(mode="json", by_alias=True) if isinstance(document, Answer) else document
    body = payload(RecordPayload, revision=revision, kind=kind, document=told, note=note)
    return post(_path(design_id, "/records"), RecordAnswer, body, patience_s=_BUSY_S)


def records(design_id: str) -> Call[RecordsAnswer]:
    """Return what was kept with a design, the newest first."""
    return get(_path(design_id, "/records"), RecordsAnswer, _BUSY_S)


def record(design_id: str, record_id: str) -> Call[RecordContentAnswer]:
    """Return the document of what was kept."""
    return get(_path(design_id, f"/records/{_called(record_id)}"), RecordContentAnswer, _BUSY_S)


def seen_devices() -> Call[SeenDevicesAnswer]:
    """Return the controllers that were ever connected, that seen last first."""
    return get("library/devices", SeenDevicesAnswer, _BUSY_S)


def search_pushes(
    *, device_id: str | None = None, design_id: str | None = None, first: int = 0, most: int | None = None
) -> Call[PushesAnswer]:
    """Return what was pushed, the newest first: to a device as seen_devices calls it, or of a design; else all."""
    body = payload(PushesPayload, device_id=device_id, design_id=design_id, first=first, most=most)
    return post("library/pushes/search", PushesAnswer, body, patience_s=_BUSY_S)


def pushed(push_id: str) -> Call[PushedToWithDesignsAnswer]:
    """Return a push with the design of each axis, and what was read back."""
    return get(f"library/pushes/{_called(push_id)}", PushedToWithDesignsAnswer, _BUSY_S)


def library_file() -> Call[bytes]:
    """Return the whole library as a file."""
    return Call("GET", "library/file", bytes, patience_s=_WHOLE_S)


def add_library_file(content: bytes) -> Call[ImportedAnswer]:
    """Add what such a file has and the library hasn't: all of it, or nothing."""
    answer = ImportedAnswer.model_validate_json
    kind = "application/octet-stream"
    return Call("POST", "library/import", answer, content, content_type=kind, patience_s=_WHOLE_S)


def _path(design_id: str, what: str = "") -> str:
    return f"library/designs/{_called(design_id)}{what}"


def _called(known: str) -> str:
    """Return what the library calls something, as it stands in a path; NotFound for what can't."""
    if not known.strip(".") or "/" in known:
        raise NotFound(f"The library has nothing that it calls {shown(known)}.")
    return quote(known, safe="")


def _of(version: int) -> dict[str, str]:
    return {"if-match": f'"{version}"'}
