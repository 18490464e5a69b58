"""The one shape in which the API tells what went wrong."""

from typing import Literal

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from pydantic import Field
from starlette.exceptions import HTTPException
from starlette.responses import Response
from starlette.routing import Match

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
from stepramp.http_api.json_response import JsonResponse
from stepramp.validation import rejected

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
METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS")


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


def error_response(error: StepRampError) -> Response:
    """Return the response that stands for an error."""
    status = next(code for kind, code in STATUS.items() if isinstance(error, kind))
    return _response(status, error_items(error))


def error_items(error: StepRampError) -> list[ErrorItem]:
    """Return what stands for an error."""
    if isinstance(error, Rejected):
        items = [_item(rejection) for rejection in error.rejections]
        return [*items, _sentence(error.more_message)] if error.more else items
    return [_sentence(str(error))]


def handle_errors(app: FastAPI) -> None:
    """Have the application answer every error in the one shape."""

    async def own(_: Request, error: Exception) -> Response:
        assert isinstance(error, StepRampError)
        if isinstance(error, Rejected) and not isinstance(error, (NotAcceptable, UnsupportedMediaType)):
            error = in_body(error)
        return error_response(error)

    async def invalid(_: Request, error: Exception) -> Response:
        assert isinstance(error, RequestValidationError)
        return error_response(rejected(error.errors(), skip=1))

    async def http(request: Request, error: Exception) -> Response:
        assert isinstance(error, HTTPException)
        request_line = f"{request.method} {brief(request.url.path)}"
        message, headers = error.detail, dict(error.headers or {})
        if error.status_code == 405:
            headers["Allow"] = ", ".join(_methods_of(request)) or headers.get("Allow", "GET, HEAD")
            message = f"{message}: {request_line}; allowed: {headers['Allow']}."
        elif not message.endswith("."):
            message = (
                f"{message}: {request_line}. The routes are described at /docs, for programs at /api/v1/openapi.json."
            )
        return _response(error.status_code, [_sentence(message)], headers)

    async def unexpected(_: Request, error: Exception) -> Response:
        return _response(500, [_sentence(f"StepRamp made a mistake: {type(error).__name__}. It is logged.")])

    app.add_exception_handler(StepRampError, own)
    app.add_exception_handler(RequestValidationError, invalid)
    app.add_exception_handler(HTTPException, http)
    app.add_exception_handler(Exception, unexpected)


def in_body(error: Rejected) -> Rejected:
    """Return the rejection of a design's field with the field's path in the request's body, where designs are."""
    return Rejected(
        [each.within("design.") if _is_of_design(each.field) else each for each in error.rejections],
        error.more,
    )


def _is_of_design(field: str) -> bool:
    """Tell whether a field is one of a design's: `axis` alone is the number of the axis that a request moves."""
    return field != "axis" and field.partition(".")[0] in Design.model_fields


def _methods_of(request: Request) -> list[str]:
    """Return the methods that the routes of a request's path know; none for the path of a file."""
    routes = request.app.router.routes
    scopes = {method: {**request.scope, "method": method} for method in METHODS}
    return [
        method for method, scope in scopes.items() if any(route.matches(scope)[0] is Match.FULL for route in routes)
    ]


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


def _sentence(message: str) -> ErrorItem:
    return ErrorItem(field=None, value=None, allowed=None, message=message)


def _response(status: int, items: list[ErrorItem], headers: dict[str, str] | None = None) -> Response:
    return JsonResponse(ErrorList(errors=items), status, headers)
