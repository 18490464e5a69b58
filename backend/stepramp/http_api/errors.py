"""Errors as answers: all in the one shape, also where the framework raises them."""

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.responses import Response
from starlette.routing import Match

from stepramp.errors import (
    NotAcceptable,
    Rejected,
    StepRampError,
    UnsupportedMediaType,
    brief,
)
from stepramp.http_api.error_items import STATUS, ErrorItem, ErrorList, error_items, in_body, sentence
from stepramp.http_api.json_response import JsonResponse
from stepramp.validation import rejected

METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS")


def error_response(error: StepRampError) -> Response:
    """Return the response that stands for an error."""
    status = next(code for kind, code in STATUS.items() if isinstance(error, kind))
    return _response(status, error_items(error))


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
        return _response(error.status_code, [sentence(message)], headers)

    async def unexpected(_: Request, error: Exception) -> Response:
        return _response(500, [sentence(f"StepRamp made a mistake: {type(error).__name__}. It is logged.")])

    app.add_exception_handler(StepRampError, own)
    app.add_exception_handler(RequestValidationError, invalid)
    app.add_exception_handler(HTTPException, http)
    app.add_exception_handler(Exception, unexpected)


def _methods_of(request: Request) -> list[str]:
    """Return the methods that the routes of a request's path know; none for the path of a file."""
    routes = request.app.router.routes
    scopes = {method: {**request.scope, "method": method} for method in METHODS}
    return [
        method for method, scope in scopes.items() if any(route.matches(scope)[0] is Match.FULL for route in routes)
    ]


def _response(status: int, items: list[ErrorItem], headers: dict[str, str] | None = None) -> Response:
    return JsonResponse(ErrorList(errors=items), status, headers)
