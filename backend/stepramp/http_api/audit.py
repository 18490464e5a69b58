"""The audit log: who pushed, moved and stopped what, and when, as lines of JSON in a file a month.

A line is written once its request has been answered, by a thread of its own: no motion and no stop waits for a disk.
"""

import hashlib
import json
import logging
import os
import queue
import threading
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from stepramp.http_api.door import is_stop
from stepramp.http_api.sign_in import acts, client_of

LONGEST_BODY = 4096
"""Of a longer body only its size, what tells it apart, and the names of its designs are written [bytes]."""
MOST_HASHED = 2_000_000
_HOLD = '"hold"'
"""In a jog's message that only says that it goes on."""

_logger = logging.getLogger(__name__)


class AuditLog:
    """The files, below a folder; from any thread."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._lines: queue.SimpleQueue[dict[str, Any] | None] = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._write, name="audit", daemon=True)
        self._thread.start()

    def note(self, **said: object) -> None:
        """Have a line written, at once but not here."""
        self._lines.put({"at": datetime.now(UTC).isoformat(timespec="milliseconds"), **said})

    def close(self) -> None:
        """Wait until all is written."""
        self._lines.put(None)
        self._thread.join()

    def _write(self) -> None:
        while (said := self._lines.get()) is not None:
            try:
                self._folder.mkdir(parents=True, exist_ok=True)
                with (self._folder / f"{str(said['at'])[:7]}.jsonl").open("a", encoding="utf-8") as file:
                    file.write(json.dumps(said, ensure_ascii=False) + "\n")
                    file.flush()
                    os.fsync(file.fileno())
            except OSError:
                _logger.exception("The audit log can't be written; what was asked: %s", said)


class Audited:
    """Middleware: notes what acts on devices or stops them, with its body and what was answered, also if that is a no.

    It stands before SignIn, which says in the scope who asks; what nobody who is known asks for isn't noted.
    """

    def __init__(self, app: ASGIApp, log: AuditLog) -> None:
        self._app = app
        self._log = log

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass all of it on."""
        if scope["type"] == "lifespan" or not _is_noted(scope):
            await self._app(scope, receive, send)
            return
        status: int | None = None
        body = bytearray()

        async def heard() -> Message:
            message = await receive()
            if message["type"] == "http.request" and len(body) <= MOST_HASHED:
                body.extend(message.get("body", b""))
            elif message["type"] == "websocket.receive" and _HOLD not in (text := message.get("text") or ""):
                self._log.note(**_about(scope), said=text[:LONGEST_BODY])
            return message

        async def told(message: Message) -> None:
            nonlocal status
            if message["type"] in ("http.response.start", "websocket.http.response.start"):
                status = message["status"]
            await send(message)

        try:
            await self._app(scope, heard, told)
        finally:
            if scope["type"] == "http" and client_of(scope) is not None:
                self._log.note(**_about(scope), **_told_of(bytes(body)), status=status)


def _is_noted(scope: Scope) -> bool:
    of_devices = str(scope["path"]).startswith("/api/v1/devices/") or scope["path"] == "/api/v1/devices"
    # Stops are everybody's, and are noted all the same, over the socket of events too.
    return acts(scope) or (of_devices and (scope["type"] == "websocket" or is_stop(scope)))


def _about(scope: Scope) -> dict[str, object]:
    pages = parse_qs(scope["query_string"].decode("ascii", "replace")).get("page", [None])
    client = client_of(scope)
    return {
        "client": None if client is None else client.name,
        "role": None if client is None else str(client.role),
        "page": Headers(scope=scope).get("X-StepRamp-Page") or pages[0],
        "asked": f"{scope.get('method', 'WebSocket')} {scope['path']}",
    }


def _told_of(body: bytes) -> dict[str, object]:
    if not body:
        return {}
    try:
        content = json.loads(body)
    except ValueError:
        return {"bytes": len(body)}
    if len(body) <= LONGEST_BODY:
        return {"body": content}
    digest = hashlib.sha256(body).hexdigest()
    return {"bytes": len(body), "sha256": digest, "designs": _names(content)}


def _names(content: object) -> list[object]:
    """Return the names of the designs of a request, the one of one axis or those of all."""
    if not isinstance(content, dict):
        return []
    designs = [content.get("design"), *(content.get("axes") or [])]
    return [each.get("name") for each in designs if isinstance(each, dict)]
