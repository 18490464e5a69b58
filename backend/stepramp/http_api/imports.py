"""The route that makes designs of the text that a controller tells its settings as."""

from collections.abc import Iterable, Iterator
from contextlib import suppress

from fastapi import APIRouter

from stepramp.controllers.families import Family
from stepramp.controllers.read_axis import with_notes
from stepramp.design import Design
from stepramp.devices.backups import unmarked
from stepramp.errors import Rejected, Rejection, shown
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.device_registry import Registry
from stepramp.http_api.imports_models import ImportAnswer, ImportPayload
from stepramp.http_api.lanes import PLANNING

LONGEST_QUOTED = 60
"""So much of a text that nobody knows is told back [characters]."""
router = APIRouter(tags=["planning"], route_class=JsonRoute)


@router.post("/import")
@PLANNING.serves
def designs_of_text(request: ImportPayload, devices: Registry) -> ImportAnswer:
    """Return designs of what a controller lists of itself, as grbl after `$$`: one for each of its axes."""
    # Some editors begin files with a byte order mark.
    # What is copied from a page may have spaces that don't break.
    text = unmarked(request.text.removeprefix("\ufeff")).replace("\N{NO-BREAK SPACE}", " ")
    families = [each for each in devices.families.values() if each.read_settings is not None]
    refused: dict[str, tuple[str, Rejected]] = {}
    for family in families:
        try:
            axes = family.read_settings(text, request.base) if family.read_settings is not None else []
        except Rejected as error:
            # Its names may as well be another one's, which takes the text.
            refused.setdefault(family.kind, (family.title, error))
            continue
        if axes:
            others = [each for each in families if each.kind != family.kind and each.same_as is None]
            notes = [*_refused_words(refused.values()), *_left_out(others, text, request.base)]
            return ImportAnswer.model_validate({"family": family.name, "axes": with_notes(axes, notes)})
    if refused:
        raise next(error for _, error in refused.values())
    known = "; ".join(f"{family.title}'s {family.reads}" for family in families if family.same_as is None)
    allowed, begun = f"what a controller tells of itself: {known}", _begun(text)
    reason = f"What begins with {shown(begun)} is nothing that is known; allowed: {allowed}."
    raise Rejected([Rejection("text", begun, allowed, reason=reason)])


def _refused_words(refused: Iterable[tuple[str, Rejected]]) -> Iterator[str]:
    """Yield which families have refused what seemed to be theirs, and why."""
    for title, error in refused:
        yield f"What {title} tells seems to be in the text, too, and is left out: {error}"


def _left_out(families: Iterable[Family], text: str, base: Design) -> Iterator[str]:
    """Yield which other families' settings are in a text, too."""
    for family in families:
        # What one of them would refuse may as well be another one's words.
        with suppress(Rejected):
            if family.read_settings is not None and family.read_settings(text, base):
                yield f"What {family.title} tells is in the text, too, and is left out: bring it on its own."


def _begun(text: str) -> str:
    """Return the first line that has something in it: enough to know it by."""
    return next((line.strip() for line in text.splitlines() if line.strip()), "")[:LONGEST_QUOTED]
