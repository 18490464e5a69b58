"""The application: routes, pages, and what guards them."""

import asyncio
import os
import threading
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from functools import cache
from itertools import chain
from pathlib import Path
from typing import Any

from fastapi import FastAPI
from fastapi.routing import iter_route_contexts
from starlette.routing import BaseRoute
from starlette.types import Receive, Scope, Send

from stepramp.capture.warm_up import warm_up_captures
from stepramp.controllers.families import FAMILIES, Family
from stepramp.controllers.own_ramp import warm_up_own_ramps
from stepramp.devices.registry import Devices
from stepramp.exports.machines.machines import MACHINES
from stepramp.http_api import (
    capture,
    curves,
    devices,
    exports,
    history,
    imports,
    jobs,
    library,
    library_file,
    methods,
    motor,
    motor_fastest,
    motor_presets,
    own_ramps,
    pages,
    planning,
    report,
    retarget,
    roles,
    schedule,
    shapes,
    stall_map,
    tables,
)
from stepramp.http_api.access import Access
from stepramp.http_api.answered import Answered
from stepramp.http_api.audit import Audited, AuditLog
from stepramp.http_api.client_limits import ClientLimits
from stepramp.http_api.connections import Connections
from stepramp.http_api.description import complete
from stepramp.http_api.door import Door
from stepramp.http_api.error_items import ErrorList
from stepramp.http_api.errors import handle_errors
from stepramp.http_api.history_keeper import HistoryKeeper
from stepramp.http_api.idempotency import Idempotent
from stepramp.http_api.job_registry import Jobs
from stepramp.http_api.journal import Journal
from stepramp.http_api.key_ages import KeyAges
from stepramp.http_api.lanes import COMPILED
from stepramp.http_api.news import News
from stepramp.http_api.relief import Relief
from stepramp.http_api.request_numbers import RequestNumbering
from stepramp.http_api.security import OwnPagesOnly, with_policy
from stepramp.http_api.sign_in import SignIn
from stepramp.library.database import URL_VARIABLE, Database
from stepramp.library.history import History
from stepramp.library.library import Library
from stepramp.library.records import Records
from stepramp.library.whole import Whole
from stepramp.link.remote_ports import RemotePorts
from stepramp.link.serial_port import NO_REMOTE_PORTS
from stepramp.motor.warm_up import warm_up_motor
from stepramp.ramp.warm_up import warm_up
from stepramp.version import __version__

DESCRIPTION = """
Plans stepper-motor ramps and plays them on attached controllers.

A design is one JSON document. Every rejection names the field, its value and what is allowed, in one shape on all
routes: also 404 for a path that isn't there, 405 for a method that a path doesn't know, 413 for a body that is too
large and 415 for one that isn't application/json. Words and units are those of the page: intervals in ticks of the
design's timer, speeds in steps/s.
"""

RESPONSES: dict[int | str, dict[str, Any]] = {
    403: {"model": ErrorList, "description": "The request comes from a page or a host that isn't ours"},
    422: {"model": ErrorList, "description": "A value can't be used"},
    500: {"model": ErrorList, "description": "StepRamp made a mistake; it is logged"},
    503: {"model": ErrorList, "description": "Too much is asked for at the same time; a stop never is"},
}
PARTS = (
    planning,
    methods,
    shapes,
    retarget,
    motor,
    motor_fastest,
    motor_presets,
    stall_map,
    jobs,
    curves,
    schedule,
    tables,
    exports,
    capture,
    report,
    own_ramps,
    imports,
    roles,
    library,
    library_file,
    history,
    devices,
)
"""Modules with routes, in the order in which the description of the API has them."""


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    """Compile the numerics in the background; at the end let go of every device, one that moves being stopped first."""
    threading.Thread(target=_warm_up, args=[app.state.devices.families], daemon=True).start()
    app.state.devices.look_for_lost_ones()
    app.state.news = News(app.state.devices)
    publishing = asyncio.create_task(app.state.news.publish())
    yield
    publishing.cancel()
    app.state.jobs.close()
    app.state.devices.close()
    app.state.history_keeper.close()
    app.state.library.close()
    if app.state.audit is not None:
        app.state.audit.close()


def _warm_up(families: Mapping[str, Family]) -> None:
    warm_up()
    COMPILED.set()
    warm_up_motor()
    warm_up_captures()
    plays = chain((each.play_own for each in families.values()), (each.play_own for each in MACHINES.values()))
    warm_up_own_ramps(plays)


class Application(FastAPI):
    """The application, whose every answer carries the guards' headers, also where the framework itself answers."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve a request, a WebSocket, or the application's own beginning and end."""
        await super().__call__(scope, receive, with_policy(scope, send))

    def openapi(self) -> dict[str, Any]:
        """Return the description of the API."""
        if self.openapi_schema is None:
            complete(super().openapi())
        return super().openapi()


def create_app(
    families: Mapping[str, Family] = FAMILIES,
    remote_ports: RemotePorts = NO_REMOTE_PORTS,
    data: Path | None = None,
    access: Access | None = None,
    host: str = "127.0.0.1",
) -> FastAPI:
    """Return the application with no device connected; families, remote_ports, data: see Devices.

    access: who may use it from other machines; None: this machine only, whoever is there. host: its address, as it
    stands in one of a page.
    """
    app = Application(
        title="StepRamp",
        version=__version__,
        description=DESCRIPTION,
        docs_url=None,
        redoc_url=None,
        openapi_url="/api/v1/openapi.json",
        lifespan=_lifespan,
        redirect_slashes=False,
    )
    app.state.devices = Devices(families, remote_ports, data)
    app.state.connections = Connections()
    app.state.jobs = Jobs()
    database = Database(app.state.devices.data, os.environ.get(URL_VARIABLE))
    app.state.library, app.state.records, app.state.whole_library = (
        Library(database),
        Records(database),
        Whole(database),
    )
    app.state.history_keeper = HistoryKeeper(History(database))
    app.state.audit = None
    app.router.routes.extend(_routes())
    handle_errors(app)
    pages.add(app)
    app.add_middleware(Idempotent)
    app.add_middleware(Door)
    app.add_middleware(Relief)
    app.add_middleware(Journal)
    if access is None:
        app.add_middleware(KeyAges)
        app.add_middleware(OwnPagesOnly, host=host)
    else:
        app.state.audit = AuditLog(app.state.devices.data / "audit")
        app.add_middleware(ClientLimits)
        app.add_middleware(KeyAges)
        app.add_middleware(SignIn, access=access)
        app.add_middleware(Audited, log=app.state.audit)
        app.add_middleware(OwnPagesOnly, scheme=access.scheme, is_named_at_will=True, public_url=access.public_url)
    now = app.state.devices.order.next
    app.add_middleware(Answered, now=now, connections=app.state.connections)
    app.add_middleware(RequestNumbering, now=now)
    return app


@cache
def _routes() -> list[BaseRoute]:
    """Build what the routes take and answer, once for all applications, and not when the first request comes.

    FastAPI silences warnings of its own making while it does that, for the whole process; what is compiled in another
    thread at the time sets its own, and brings them back.
    """
    api = FastAPI(openapi_url=None, redirect_slashes=False, responses=RESPONSES)
    for part in PARTS:
        api.include_router(part.router, prefix="/api/v1")
    for _ in iter_route_contexts(api.routes):
        pass
    return api.routes
