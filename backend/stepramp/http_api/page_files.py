"""Files for browsers: asked about each time, or, the page's own, kept under an address that changes with them."""

import hashlib
import json
import re
from collections.abc import Callable
from pathlib import Path

from anyio import to_thread
from starlette.exceptions import HTTPException
from starlette.responses import Response
from starlette.staticfiles import StaticFiles
from starlette.types import Receive, Scope, Send

from stepramp.errors import NotFound, brief
from stepramp.http_api.errors import error_response
from stepramp.http_api.methods_models import MethodsAnswer
from stepramp.http_api.motor_presets_models import MotorPresetsAnswer
from stepramp.http_api.number_fields import design_fields, device_fields
from stepramp.http_api.shapes_models import ShapesAnswer

ASKED_EACH_TIME = "no-cache"
KEPT = "max-age=31536000, immutable"
START = "index.html"
READS = ("GET", "HEAD")
LINKS = re.compile(r'((?:href|src)=")(?!assets/plotly|#)')
"""Before the addresses of the page's own files in its first page."""

WRITTEN: dict[Path, Callable[[], str]] = {
    # What GET /api/v1/methods, /shapes and /motor/presets answer, for the page to import: it has no lists of its own.
    Path("assets/methods.js"): lambda: MethodsAnswer.of_all().model_dump_json(),
    Path("assets/shapes.js"): lambda: ShapesAnswer.of_all().model_dump_json(),
    Path("assets/motors.js"): lambda: MotorPresetsAnswer.of_all().model_dump_json(exclude_unset=True),
    Path("assets/design_fields.js"): lambda: json.dumps(design_fields()),
    Path("assets/device_fields.js"): lambda: json.dumps(device_fields()),
}
"""Modules that are no files, and the value that each exports."""


class AskedEachTime(StaticFiles):
    """Files that a browser asks about each time, so that a new version is never mixed with an old one."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        """Return the answer for a path below the folder; what lies below /api is no file."""
        if scope["path"].startswith("/api/") or "\0" in path:
            raise HTTPException(404)
        return await super().get_response(path, scope)

    def file_response(self, *args: object, **kwargs: object) -> Response:
        """Return the file, or that it hasn't changed."""
        response = super().file_response(*args, **kwargs)  # type: ignore[arg-type]  # handed on as they come
        response.headers["cache-control"] = ASKED_EACH_TIME
        return response


class PageFiles(AskedEachTime):
    """The page's files. Its first page names them below their version, where a browser asks for each of them once."""

    def __init__(self, folder: Path) -> None:
        super().__init__(directory=folder, html=True)
        self._folder = folder
        self._written = {path: f"export default {value()};\n" for path, value in WRITTEN.items()}
        self._version = self._look()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request with a file; a WebSocket, which no file can serve, with 404 and the reason."""
        if scope["type"] == "websocket":
            told = f"There is no WebSocket {brief(scope['path'])}. /api/v1/openapi.json describes those that are."
            await error_response(NotFound(told))(scope, receive, send)
        else:
            await super().__call__(scope, receive, send)

    async def get_response(self, path: str, scope: Scope) -> Response:
        """Return the answer for a path, be it below the version or not. Raises 404 for another version's files."""
        if path in (".", START) and scope["method"] in READS:
            return await to_thread.run_sync(self._start)
        version, *below = Path(path).parts
        is_kept = version == self._version and below != []
        file = Path(*below) if is_kept else Path(path)
        written = self._written.get(file)
        if written is not None and scope["method"] in READS:
            response = Response(written, media_type="text/javascript", headers={"cache-control": ASKED_EACH_TIME})
        else:
            response = await super().get_response(str(file), scope)
        if is_kept:
            response.headers["cache-control"] = KEPT
        return response

    def _start(self) -> Response:
        self._version = self._look()
        text = LINKS.sub(rf"\1{self._version}/", (self._folder / START).read_text())
        return Response(text, headers={"cache-control": ASKED_EACH_TIME}, media_type="text/html")

    def _look(self) -> str:
        """Return what stands for the files as they are now."""
        digest = hashlib.sha256("".join(self._written.values()).encode())
        for file in sorted(self._folder.rglob("*")):
            about = file.stat()
            digest.update(f"{file.relative_to(self._folder)} {about.st_size} {about.st_mtime_ns}\n".encode())
        return f"page-{digest.hexdigest()[:12]}"
