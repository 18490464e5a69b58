"""The one shape in which the API tells what went wrong, and what stands in it for each error."""

from typing import Literal

from pydantic import Field

from stepramp.design import Design
from stepramp.errors import (
    DeviceLost,
    Forbidden,
    NotAcceptable,
    NotFound,
    Outdated,
    Overloaded,
    Refused,
    Rejected,
    Rejection,
    StepRampError,
    StepUnit,
    TooOften,
    Unauthorized,
    Unavailable,
    UnsupportedMediaType,
    brief,
)
from stepramp.http_api.answer import Answer

STATUS: dict[type[StepRampError], int] = {
    NotAcceptable: 406,
    UnsupportedMediaType: 415,
    Rejected: 422,
    NotFound: 404,
    Refused: 409,
    Outdated: 412,
    Forbidden: 403,
    Unauthorized: 401,
    TooOften: 429,
    DeviceLost: 502,
    Overloaded: 503,
    Unavailable: 503,
}


class LimitsAnswer(Answer):
    """From where to where a number may lie; for a text or a list, how long it may be."""

    lowest: float | None = Field(description="The least that is allowed; null: no end")
    highest: float | None = Field(description="The most that is allowed; null: no end")
    is_whole: bool = Field(description="Whether only whole numbers are allowed")
    note: str = Field(
        description="What follows them and their unit in a sentence: why they hold, or what is allowed besides"
    )


TOLD = "The quantities of the message that a design's axis converts, in their order, to be told in other units"
TOLD_OF_EACH = (
    "Of each sentence, the quantities that a design's axis converts, in their order, to be told in other units"
)


class ToldAnswer(Answer):
    """A quantity of a message, as data."""

    text: str = Field(description="As it stands in the message")
    value: float = Field(description="What it is [its unit]")
    unit: StepUnit = Field(description="Its unit")
    rounding: Literal["nearest", "down", "up"] = Field(
        description="To which side it is rounded: a limit so that what is told is allowed"
    )
    axis: int | None = Field(
        description="Axis that it is of, counted from 0 as in the request; null: the one that the message is about"
    )


class ChangeAnswer(Answer):
    """A value that would be accepted in place of the present one."""

    field: str = Field(description="Path of the field in the request's body")
    value: object = Field(description="What to put there")


class ChoicesAnswer(Answer):
    """What is allowed while another field has its value."""

    names: list[str] = Field(description="Any of them; of something that is needed the one thing, in words")
    because: ChangeAnswer = Field(description="The other field and its value")
    is_need: bool = Field(description="Whether something is missing that the other field's value needs")


class RemedyAnswer(Answer):
    """Changes that together make what was refused acceptable: they were tried."""

    text: str = Field(description="What people call it")
    changes: list[ChangeAnswer]
    told: list[ToldAnswer] = Field(
        default=[], description="The quantities of the text that a design's axis converts, in their order"
    )


class ErrorItem(Answer):
    """One thing that is wrong."""

    field: str | None = Field(description="Path of the field in the request's body; null when it is no field's fault")
    value: object = Field(description="What was given")
    allowed: str | None = Field(description="What is allowed")
    message: str = Field(description="The same as a sentence")
    limits: LimitsAnswer | None = Field(
        None,
        description="What `allowed` says of a number, or of a length; left out where it says no such thing",
    )
    unit: str | None = Field(None, description="Unit of the limits, '' for mere numbers; left out without limits")
    reason: str | None = Field(
        None, description="Why, where more than the value is wrong: the message, and it names no field; else left out"
    )
    told: list[ToldAnswer] | None = Field(None, description=f"{TOLD}; left out where there are none")
    choices: ChoicesAnswer | None = Field(None, description="What `allowed` says where that is names; else left out")
    remedies: list[RemedyAnswer] | None = Field(
        None, description="What would be accepted instead; left out where nothing is known"
    )


class ErrorList(Answer):
    """What went wrong, the same for all routes."""

    errors: list[ErrorItem]


def error_items(error: StepRampError) -> list[ErrorItem]:
    """Return what stands for an error."""
    if isinstance(error, Rejected):
        items = [_item(rejection) for rejection in error.rejections]
        return [*items, sentence(error.more_message)] if error.more else items
    return [_refusal(error)]


def in_body(error: Rejected) -> Rejected:
    """Return the rejection of a design's field with the field's path in the request's body, where designs are."""
    return Rejected(
        [each.within("design.") if _is_of_design(each.field) else each for each in error.rejections],
        error.more,
    )


def _is_of_design(field: str) -> bool:
    """Tell whether a field is one of a design's: `axis` alone is the number of the axis that a request moves."""
    return field != "axis" and field.partition(".")[0] in Design.model_fields


def _item(rejection: Rejection) -> ErrorItem:
    known: dict[str, object] = {}
    if rejection.limits is not None:
        known |= {"limits": LimitsAnswer.model_validate(rejection.limits), "unit": rejection.limits.unit}
    if rejection.reason:
        known["reason"] = rejection.reason
    if rejection.told:
        known["told"] = [ToldAnswer.model_validate(each) for each in rejection.told]
    if rejection.choices:
        known["choices"] = ChoicesAnswer.model_validate(rejection.choices)
    if rejection.remedies:
        known["remedies"] = [RemedyAnswer.model_validate(each) for each in rejection.remedies]
    return ErrorItem(
        field=rejection.field,
        value=brief(rejection.value),
        allowed=rejection.allowed,
        message=rejection.message,
        **known,
    )


def sentence(message: str) -> ErrorItem:
    """Return what stands for something that is no field's fault."""
    return ErrorItem(field=None, value=None, allowed=None, message=message)


def _refusal(error: StepRampError) -> ErrorItem:
    if not isinstance(error, Refused):
        return sentence(str(error))
    return ErrorItem(field=error.field, value=brief(error.value), allowed=error.allowed, message=str(error))
