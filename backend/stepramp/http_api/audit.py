"""The audit log: who pushed, moved and stopped what, and when, as lines of JSON in a file a month.

A line is made and written once its request has been answered, by a thread of its own: no motion and no stop waits for a
disk, nor for a body to be read. What waits for the disk is bounded; a line tells how many are lacking.
"""

import hashlib
import json
import logging
import os
import queue
import sys
import threading
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import groupby
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from stepramp.errors import Rejected
from stepramp.http_api.door import is_stop
from stepramp.http_api.idempotency import REPLAYED_HEADER
from stepramp.http_api.sign_in import acts, client_of
from stepramp.json_text import parsed_json

LONGEST_BODY = 4096
"""Of a longer body only its size, what tells it apart, and the names of its designs are written [bytes]."""
MOST_READ = 2_000_000
"""A longer body is not read for names [bytes]."""
MOST_KEPT = 16_000_000
"""Size of all bodies together that are coming in or wait to be written; others aren't read for names [bytes]."""
MOST_LINES = 1000
"""So many wait to be written, of what is said over WebSockets half as many; those that come then are lost."""
MOST_NAMES = 8
LONGEST_NAME = 200
LONGEST_QUERY = 4096
LONGEST_HOLD = 64
"""A longer message isn't looked at for whether it only says that a jog goes on [characters]."""

_logger = logging.getLogger(__name__)


class _Body:
    """A body as it comes in: its size, its hash, and all of it where that has room."""

    def __init__(self, log: "AuditLog") -> None:
        self._log = log
        self._parts: list[bytes] | None = []
        self._kept_bytes = 0
        self._digest = hashlib.sha256()
        self.size_bytes = 0

    def add(self, part: bytes) -> None:
        """Take one more part."""
        self.size_bytes += len(part)
        self._digest.update(part)
        if self._parts is not None and self.size_bytes <= MOST_READ and self._log.take_room(len(part)):
            self._parts.append(part)
            self._kept_bytes += len(part)
        else:
            self.let_go()

    def let_go(self) -> None:
        """Keep but size and hash."""
        self._log.take_room(-self._kept_bytes)
        self._parts, self._kept_bytes = None, 0

    def told(self) -> dict[str, object]:
        """Return what is written of it."""
        if self.size_bytes == 0:
            return {}
        told: dict[str, object] = {"bytes": self.size_bytes, "sha256": self._digest.hexdigest()}
        if self._parts is None:
            return told
        whole = b"".join(self._parts)
        is_short = len(whole) <= LONGEST_BODY
        try:
            content = parsed_json(whole.decode())
            if is_short:
                body = {"body": content}
                json.dumps(body)  # What can be read may be nested too deeply to be written.
                return body
        except (ValueError, RecursionError, Rejected):
            # As it was sent: it may have stopped a motor all the same.
            return {"text": whole.decode(errors="backslashreplace")} if is_short else told
        return {**told, "designs": _names(content)}


@dataclass
class _Line:
    """What a line says, but for its body, which is read later."""

    said: dict[str, Any]
    body: _Body | None = None

    def text(self) -> str:
        """Return it as JSON."""
        return json.dumps({**self.said, **({} if self.body is None else self.body.told())}, ensure_ascii=False)


class AuditLog:
    """The files, below a folder; from any thread."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._lines: queue.SimpleQueue[_Line | None] = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._kept_bytes = 0
        self._lost = 0
        self._thread = threading.Thread(target=self._write, name="audit", daemon=True)
        self._thread.start()

    def note(self, said: dict[str, object], body: _Body | None = None, most_lines: int = MOST_LINES) -> None:
        """Have a line written, at once but not here; it is lost when so many wait already."""
        if self._lines.qsize() < most_lines:
            self._lines.put(_Line({"at": _now(), **said}, body))
            return
        self._lose(1)
        if body is not None:
            body.let_go()

    def take_room(self, size_bytes: int) -> bool:
        """Take room for a part of a body, if there is any, or give it back."""
        with self._lock:
            has_room = self._kept_bytes + size_bytes <= MOST_KEPT
            self._kept_bytes += size_bytes if has_room else 0
            return has_room

    def close(self) -> None:
        """Wait until all is written."""
        self._lines.put(None)
        self._thread.join()

    def _lose(self, count: int) -> None:
        with self._lock:
            self._lost += count

    def _write(self) -> None:
        is_over = False
        while not is_over:
            waiting = [self._lines.get()]
            # All together: a disk takes as long for one line as for hundreds.
            while not self._lines.empty():
                waiting.append(self._lines.get())
            is_over = None in waiting
            try:
                self._append([each for each in waiting if each is not None])
            except Exception:
                _logger.exception("The audit log can't be written.")

    def _append(self, lines: list[_Line]) -> None:
        texts = [each for each in map(self._made, lines) if each is not None]
        for month, group in groupby(texts, key=lambda each: each[0]):
            self._append_to(month, [text for _, text in group])
        with self._lock:
            lost, self._lost = self._lost, 0
        if lost:
            now = _now()
            self._append_to(now[:7], [json.dumps({"at": now, "lost": lost})], lost)

    def _made(self, line: _Line) -> tuple[str, str] | None:
        """Return the month and the text of a line; None when it can't be made, which is logged."""
        try:
            return str(line.said["at"])[:7], line.text()
        except Exception:
            self._lose(1)
            _logger.exception("A line of the audit log can't be made: %s", line.said)
            return None
        finally:
            if line.body is not None:
                line.body.let_go()

    def _append_to(self, month: str, texts: list[str], told_lost: int = 0) -> None:
        """Write lines; they are logged, and lost, where that can't be done. told_lost: of how many they tell that."""
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            path = self._folder / f"{month}.jsonl"
            is_cut = _is_cut_off(path)
            with os.fdopen(_opened(path), "a", encoding="utf-8", errors="backslashreplace") as file:
                if is_cut:
                    file.write("\n")
                file.writelines(f"{text}\n" for text in texts)
                file.flush()
                os.fsync(file.fileno())
        except OSError:
            self._lose(told_lost or len(texts))
            _logger.exception("The audit log can't be written; what was asked: %s", "\n".join(texts))


def _is_cut_off(path: Path) -> bool:
    """Return whether a file's last line was cut off, as by a disk without room: the next one begins behind it."""
    try:
        with path.open("rb") as file:
            return file.seek(0, os.SEEK_END) > 0 and file.seek(-1, os.SEEK_END) >= 0 and file.read() != b"\n"
    except OSError:  # It is new, or may only be written to.
        return False


def _opened(path: Path) -> int:
    """Open a file to append to that nobody but its user may read, also one that an older version began."""
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    if sys.platform != "win32":
        with suppress(OSError):  # It is another user's: the log goes on.
            os.fchmod(descriptor, 0o600)
    return descriptor


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
        repeats: dict[str, object] = {}
        body, asked_at = _Body(self._log), _now()

        async def heard() -> Message:
            message = await receive()
            if message["type"] == "http.request":
                body.add(message.get("body", b""))
            elif message["type"] == "websocket.receive" and not _only_goes_on(scope, message):
                self._log.note({**_about(scope), **_said(message)}, most_lines=MOST_LINES // 2)
            return message

        async def told(message: Message) -> None:
            nonlocal status, repeats
            if message["type"] in ("http.response.start", "websocket.http.response.start"):
                status = message["status"]
                repeats = {"repeats": True} if REPLAYED_HEADER in Headers(raw=message.get("headers", [])) else {}
            await send(message)

        try:
            await self._app(scope, heard, told)
        finally:
            if scope["type"] == "http" and client_of(scope) is not None:
                self._log.note({"asked_at": asked_at, **_about(scope), "status": status, **repeats}, body)
            else:
                body.let_go()


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="milliseconds")


def _is_noted(scope: Scope) -> bool:
    of_devices = str(scope["path"]).startswith("/api/v1/devices/") or scope["path"] == "/api/v1/devices"
    # Stops are everybody's, and are noted all the same, over the socket of events too.
    return acts(scope) or (of_devices and (scope["type"] == "websocket" or is_stop(scope)))


def _about(scope: Scope) -> dict[str, object]:
    pages = parse_qs(scope["query_string"][:LONGEST_QUERY].decode("ascii", "replace")).get("page", [None])
    client = client_of(scope)
    return {
        "client": None if client is None else client.name,
        "role": None if client is None else str(client.role),
        "page": Headers(scope=scope).get("X-StepRamp-Page") or pages[0],
        "asked": f"{scope.get('method', 'WebSocket')} {scope['path']}",
    }


def _only_goes_on(scope: Scope, message: Message) -> bool:
    """Return whether a message says that a jog goes on, and nothing else."""
    text = message.get("text")
    if not str(scope["path"]).endswith("/jog") or text is None or len(text) > LONGEST_HOLD:
        return False
    try:
        return parsed_json(text) == {"do": "hold"}
    except (ValueError, Rejected):
        return False


def _said(message: Message) -> dict[str, object]:
    text = message.get("text")
    if text is None:
        return {"bytes": len(message.get("bytes") or b"")}
    return {"said": text} if len(text) <= LONGEST_BODY else {"said": text[:LONGEST_BODY], "characters": len(text)}


def _names(content: object) -> list[str]:
    """Return the names of the designs of a request, the one of one axis or those of all."""
    if not isinstance(content, dict):
        return []
    axes = content.get("axes")
    designs = [content.get("design"), *(axes[:MOST_NAMES] if isinstance(axes, list) else [])]
    names = [each.get("name") for each in designs if isinstance(each, dict)]
    return [each[:LONGEST_NAME] for each in names if isinstance(each, str)]
