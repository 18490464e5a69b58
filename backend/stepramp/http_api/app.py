"""The application: routes, pages, and what guards them."""

import threading
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import FastAPI

from stepramp.controllers.devices import Devices
from stepramp.http_api import curves, devices, exports, pages, planning, schedule, tables
from stepramp.http_api.errors import ErrorList, handle_errors
from stepramp.http_api.security import LoopbackOnly
from stepramp.ramp.warm_up import warm_up
from stepramp.version import __version__

DESCRIPTION = """
Plans stepper-motor ramps and plays them on attached controllers.

A design is one JSON document. Every rejection names the field, its value and what is allowed, in one shape on all
routes. Words and units are those of the page: intervals in ticks of the design's timer, speeds in steps/s.
"""


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    """Compile the numerics in the background; at the end let go of every device, one that moves being stopped first."""
    threading.Thread(target=warm_up, daemon=True).start()
    yield
    app.state.devices.close()


def create_app() -> FastAPI:
    """Return the application with no device connected."""
    app = FastAPI(
        title="StepRamp",
        version=__version__,
        description=DESCRIPTION,
        docs_url=None,
        redoc_url=None,
        openapi_url="/api/v1/openapi.json",
        lifespan=_lifespan,
        responses={422: {"model": ErrorList, "description": "A value can't be used"}},
    )
    app.state.devices = Devices()
    app.include_router(planning.router, prefix="/api/v1")
    app.include_router(curves.router, prefix="/api/v1")
    app.include_router(schedule.router, prefix="/api/v1")
    app.include_router(tables.router, prefix="/api/v1")
    app.include_router(exports.router, prefix="/api/v1")
    app.include_router(devices.router, prefix="/api/v1")
    handle_errors(app)
    pages.add(app)
    app.add_middleware(LoopbackOnly)
    return app
