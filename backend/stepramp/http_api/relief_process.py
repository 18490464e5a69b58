"""What runs in a process of relief: routes that plan, given a request and its body, which answer all at once or not."""

import asyncio
import gc
import signal
import threading
from collections.abc import Sequence
from functools import cache
from multiprocessing import parent_process
from os import _exit
from typing import Any, NamedTuple

from fastapi import APIRouter, FastAPI
from starlette.types import ASGIApp, Message

from stepramp.executors.priority import be_nicer
from stepramp.http_api import planning
from stepramp.http_api.bodies import JsonRoute
from stepramp.http_api.errors import handle_errors
from stepramp.http_api.formats import IN_ANY_FORMAT, AnyFormat
from stepramp.http_api.lanes import AT_ONCE, COMPILED, NICER, profile_turns
from stepramp.http_api.planned import Planned
from stepramp.http_api.planning_models import ProfileAnswer, ProfilePayload
from stepramp.ramp.warm_up import warm_up

PROFILE = "/api/v1/profile"


class Asked(NamedTuple):
    """A request for a profile."""

    query_string: bytes
    headers: list[tuple[bytes, bytes]]
    body: bytes


class Answered(NamedTuple):
    """What is answered."""

    status: int
    headers: list[tuple[bytes, bytes]]
    body: bytes


class TakesLongError(Exception):
    """What was asked for is none of the small profiles that a process of relief plans."""


def begin() -> None:
    """Make a process ready: with its numerics compiled, and ending when the server does, however that ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C reaches both; the server ends this one.
    threading.Thread(target=_end_with_server, daemon=True).start()
    be_nicer(NICER)
    warm_up()
    COMPILED.set()
    _application()
    gc.freeze()


def answers(requests: Sequence[Asked]) -> list[Answered | None]:
    """Return what is answered to each; None where that would take long, or something went wrong."""
    return _runner().run(_answers(requests))


async def _answers(requests: Sequence[Asked]) -> list[Answered | None]:
    return [await _answer(request) for request in requests]


async def _answer(request: Asked) -> Answered | None:
    messages: list[Message] = []
    scope: dict[str, Any] = {
        "type": "http",
        "asgi": {"version": "3.0"},
        "http_version": "1.1",
        "method": "POST",
        "scheme": "http",
        "path": PROFILE,
        "raw_path": PROFILE.encode(),
        "root_path": "",
        "query_string": request.query_string,
        "headers": request.headers,
    }

    async def receive() -> Message:
        return {"type": "http.request", "body": request.body, "more_body": False}

    async def send(message: Message) -> None:
        messages.append(message)

    try:
        await _application()(scope, receive, send)
    except Exception:
        # The server serves it itself, and tells what went wrong.
        return None
    start, *parts = messages
    return Answered(start["status"], list(start["headers"]), b"".join(each.get("body", b"") for each in parts))


@cache
def _application() -> ASGIApp:
    app, router = FastAPI(openapi_url=None, redirect_slashes=False), APIRouter(route_class=JsonRoute)

    @router.post(PROFILE, responses=IN_ANY_FORMAT)
    async def profile(request: ProfilePayload, as_wanted: AnyFormat) -> Planned[ProfileAnswer]:
        if profile_turns(request.design, request.max_points) is not AT_ONCE:
            raise TakesLongError
        return await planning.profile(request, as_wanted)

    app.include_router(router)
    handle_errors(app)
    return app


@cache
def _runner() -> asyncio.Runner:
    return asyncio.Runner()


def _end_with_server() -> None:
    server = parent_process()
    assert server is not None
    server.join()
    _exit(0)
