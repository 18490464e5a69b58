"""The page, the API's own pages and the scripts they need: files on this machine, nothing from elsewhere."""

from importlib.resources import files
from pathlib import Path

import fastapi_offline
import plotly
from fastapi import FastAPI
from starlette.exceptions import HTTPException
from starlette.responses import FileResponse, Response
from starlette.staticfiles import StaticFiles
from starlette.types import Scope

from stepramp.http_api.methods_models import MethodsAnswer

PACKAGE = Path(str(files("stepramp")))
PLOTLY = Path(plotly.__file__).parent / "package_data"
SWAGGER_UI = Path(fastapi_offline.__file__).parent / "static"


def frontend() -> Path:
    """Return the folder of the page: inside an installed package, beside `backend/` in a checkout."""
    installed = PACKAGE / "frontend"
    return installed if installed.is_dir() else PACKAGE.parents[1] / "frontend"


class Revalidated(StaticFiles):
    """Files that a browser asks about each time, so that a new version is never mixed with an old one."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        """Return the answer for a path below the folder; what lies below /api is no file."""
        if scope["path"].startswith("/api/") or "\0" in path:
            raise HTTPException(404)
        return await super().get_response(path, scope)

    def file_response(self, *args: object, **kwargs: object) -> Response:
        """Return the file, or that it hasn't changed."""
        response = super().file_response(*args, **kwargs)  # type: ignore[arg-type]  # handed on as they come
        response.headers["cache-control"] = "no-cache"
        return response


def add(app: FastAPI) -> None:
    """Add the page at /, the API's page at /docs, and what they load below /assets."""

    @app.get("/docs", include_in_schema=False)
    async def docs() -> FileResponse:
        return FileResponse(frontend() / "docs" / "index.html", headers={"cache-control": "no-cache"})

    @app.get("/assets/methods.js", include_in_schema=False)
    async def methods_module() -> Response:
        # What GET /api/v1/methods answers, for the page to import: it has no list of its own.
        text = f"export default {MethodsAnswer.of_all().model_dump_json()};\n"
        return Response(text, media_type="text/javascript", headers={"cache-control": "no-cache"})

    app.mount("/assets/plotly", Revalidated(directory=PLOTLY))
    app.mount("/assets/swagger-ui", Revalidated(directory=SWAGGER_UI))
    # Not mounted: that would keep the router from telling which methods a path of the API knows.
    app.router.default = Revalidated(directory=frontend(), html=True)
