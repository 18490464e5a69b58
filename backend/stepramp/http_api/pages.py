"""The page, the API's own pages and the scripts they need: files on this machine, nothing from elsewhere."""

from importlib.resources import files
from pathlib import Path

import fastapi_offline
import plotly
from fastapi import FastAPI
from starlette.responses import FileResponse, PlainTextResponse, RedirectResponse

from stepramp.http_api.page_files import ASKED_EACH_TIME, AskedEachTime, PageFiles
from stepramp.http_api.security import HELP

PACKAGE = Path(str(files("stepramp")))
PLOTLY = Path(plotly.__file__).parent / "package_data"
SWAGGER_UI = Path(fastapi_offline.__file__).parent / "static"


async def _to_documentation() -> RedirectResponse:
    return RedirectResponse(f"{HELP}/")


async def _no_documentation() -> PlainTextResponse:
    return PlainTextResponse(
        "The documentation hasn't been built here: './dev docs' does that. Its texts are in the folder docs of the "
        "sources.\n",
        404,
    )


def frontend() -> Path:
    """Return the folder of the page: inside an installed package, beside `backend/` in a checkout."""
    installed = PACKAGE / "frontend"
    return installed if installed.is_dir() else PACKAGE.parents[1] / "frontend"


def documentation() -> Path | None:
    """Return the folder of the documentation's site: inside an installed package, or where a checkout builds it.

    None where it hasn't been built.
    """
    folders = (PACKAGE / "help", PACKAGE.parents[1] / "build" / "help")
    return next((each for each in folders if (each / "index.html").is_file()), None)


def add(app: FastAPI) -> None:
    """Add the page at /, the API's page at /docs, what they load below /assets, and the documentation at /help."""

    @app.get("/docs", include_in_schema=False)
    async def docs() -> FileResponse:
        return FileResponse(frontend() / "docs" / "index.html", headers={"cache-control": ASKED_EACH_TIME})

    @app.get("/favicon.ico", include_in_schema=False)
    async def icon() -> FileResponse:
        # Browsers ask for it by themselves wherever they are shown no page of ours, as for an answer of the API.
        return FileResponse(frontend() / "favicon.svg", headers={"cache-control": ASKED_EACH_TIME})

    if (site := documentation()) is not None:
        app.add_api_route(HELP, _to_documentation, include_in_schema=False)
        app.mount(HELP, AskedEachTime(directory=site, html=True))
    else:
        app.add_api_route(f"{HELP}/{{path:path}}", _no_documentation, include_in_schema=False)
        app.add_api_route(HELP, _no_documentation, include_in_schema=False)
    app.mount("/assets/plotly", AskedEachTime(directory=PLOTLY))
    app.mount("/assets/swagger-ui", AskedEachTime(directory=SWAGGER_UI))
    # Not mounted: that would keep the router from telling which methods a path of the API knows.
    app.router.default = PageFiles(frontend())
