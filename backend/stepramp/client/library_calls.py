"""What a client can ask of the library of designs."""

from collections.abc import Sequence
from urllib.parse import quote

from stepramp.client.calls import QUICK_S, Call, get, payload, post
from stepramp.client.design_calls import ADesign
from stepramp.http_api.library_models import (
    AboutPayload,
    ContentAnswer,
    DifferencesAnswer,
    DuplicatePayload,
    FoundAnswer,
    KeptAnswer,
    KeptWithRevisionsAnswer,
    NewDesignPayload,
    RevisionPayload,
    SearchPayload,
)

_BUSY_S = 2 * QUICK_S
"""Another who writes is waited for."""


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


def _path(design_id: str, what: str = "") -> str:
    return f"library/designs/{quote(design_id, safe='')}{what}"


def _of(version: int) -> dict[str, str]:
    return {"if-match": f'"{version}"'}
