"""What a server refuses, as the errors that StepRamp raises in one's own process."""

from collections.abc import Sequence

from pydantic import ValidationError

from stepramp.errors import (
    Change,
    Choices,
    Limits,
    NoServer,
    Refused,
    Rejected,
    Rejection,
    Remedy,
    StepRampError,
    Told,
    Unavailable,
)
from stepramp.http_api.error_items import STATUS, ChangeAnswer, ErrorItem, ErrorList, ToldAnswer

_KINDS = {status: kind for kind, status in STATUS.items() if kind is not Unavailable}
"""By the status of an answer. What is unavailable and what is too much just now have one: later they are not."""


def error_of(status: int, content: bytes, url: str) -> StepRampError:
    """Return what an answer tells that is none of success."""
    try:
        items = ErrorList.model_validate_json(content).errors
    except ValidationError:
        return NoServer(f"What answers at {url} is no StepRamp (status {status}).")
    kind = _KINDS.get(status, StepRampError)
    if kind is Refused and len(items) == 1:
        [item] = items
        return Refused(item.message, item.field, item.value, item.allowed)
    return error_of_items(items, kind)


def error_of_items(items: Sequence[ErrorItem], kind: type[StepRampError] = Refused) -> StepRampError:
    """Return what items tell: of fields that can't be used a Rejected, else an error of a kind."""
    rejections = [_rejection(item) for item in items if item.field is not None]
    sentences = [item.message for item in items if item.field is None]
    if not rejections:
        return (StepRampError if kind is Rejected else kind)("\n".join(sentences))
    # The sentence says how many there are besides.
    more = int("".join(filter(str.isdigit, sentences[0])) or 1) if sentences else 0
    return Rejected(rejections, more)


def _rejection(item: ErrorItem) -> Rejection:
    assert item.field is not None
    told = item.limits
    limits = None
    if told is not None:
        limits = Limits(told.lowest, told.highest, item.unit or "", told.is_whole, told.note)
    choices = None
    if item.choices is not None:
        choices = Choices(tuple(item.choices.names), _change(item.choices.because), item.choices.is_need)
    return Rejection(
        item.field,
        item.value,
        item.allowed or "",
        limits=limits,
        remedies=tuple(
            Remedy(each.text, tuple(map(_change, each.changes)), tuple(map(_told, each.told)))
            for each in item.remedies or []
        ),
        reason=item.reason or "",
        is_null=item.value is None and item.message.startswith(f"{item.field} is null;"),
        told=tuple(map(_told, item.told or [])),
        choices=choices,
    )


def _change(change: ChangeAnswer) -> Change:
    return Change(change.field, change.value)


def _told(told: ToldAnswer) -> Told:
    return Told(told.text, told.value, told.unit, told.rounding, told.axis)
