"""The audit log: a line for whatever is asked of devices, however it is asked, and no stop waits for it."""

from __future__ import annotations

import json
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from starlette.types import Message, Receive, Scope, Send

from event_loop import run
from stepramp.http_api import audit
from stepramp.http_api.access import CLIENT, Client, Role
from stepramp.http_api.audit import LONGEST_BODY, Audited, AuditLog

STOP = "/api/v1/devices/stop"
EVENTS = "/api/v1/devices/events"
JOG = "/api/v1/devices/1/jog"
PIECE_BYTES = 65_536


class Asked:
    """What asks over the middleware, one after the other, and reads the log."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.log = AuditLog(folder)
        self.app = Audited(self.answer, self.log)

    async def answer(self, scope: Scope, receive: Receive, send: Send) -> None:
        scope[CLIENT] = Client("somebody", Role.VIEW)
        while (await receive())["type"] == "websocket.receive" or scope.pop("more", None):
            pass
        if scope["type"] == "http":
            await send({"type": "http.response.start", "status": 200})

    def post(self, body: bytes, path: str = STOP) -> None:
        pieces = [body[begin : begin + PIECE_BYTES] for begin in range(0, len(body), PIECE_BYTES)] or [b""]
        self._ask("http", path, [{"type": "http.request", "body": each} for each in pieces])

    def say(self, path: str, *messages: dict[str, object]) -> None:
        said = [{"type": "websocket.receive", **each} for each in messages]
        self._ask("websocket", path, [*said, {"type": "websocket.disconnect"}])

    def _ask(self, kind: str, path: str, messages: list[Message]) -> None:
        async def receive() -> Message:
            message = messages.pop(0)
            scope["more"] = bool(messages)
            return message

        async def send(_: Message) -> None: ...

        scope: Scope = {"type": kind, "method": "POST", "path": path, "query_string": b"", "headers": []}
        run(self.app(scope, receive, send))

    def lines(self) -> list[dict[str, Any]]:
        """Return what was written, once all is."""
        self.log.close()
        texts = [each.read_text(encoding="utf-8") for each in sorted(self.folder.glob("*.jsonl"))]
        return [json.loads(line) for line in "".join(texts).splitlines()]


@pytest.fixture
def asked(tmp_path: Path) -> Asked:
    return Asked(tmp_path / "audit")


def test_a_line_that_a_full_disk_has_cut_off_takes_no_other_with_it(asked: Asked) -> None:
    asked.post(b"")
    asked.log.close()
    [file] = asked.folder.glob("*.jsonl")
    whole = file.read_bytes()
    for there, lines in ((b"", 1), (whole, 2), (whole + b'{"at": "20', 3), (b"x", 2)):
        file.write_bytes(there)
        again = Asked(asked.folder)
        again.post(b"")
        again.log.close()
        *_, last = file.read_text().splitlines()
        assert (len(file.read_text().splitlines()), json.loads(last)["status"]) == (lines, 200)


@pytest.mark.parametrize(
    "body",
    [b'["\\ud800"]', b"[" * 1000, b"[" * 900 + b"]" * 900, b"[" * 4000, b'{"a": 1, "a": 2}', b"\xff", b"1" * 4001],
)
def test_a_body_that_cant_be_read_is_written_as_it_was_sent_and_so_is_what_comes_after_it(
    asked: Asked, body: bytes
) -> None:
    asked.post(body)
    asked.post(b'{"axes": [0]}')
    odd, after = asked.lines()
    assert odd.get("text", json.dumps(odd.get("body"))).replace(" ", "") == body.decode(
        errors="backslashreplace"
    ).replace(" ", "")
    assert (odd["status"], after["body"]) == (200, {"axes": [0]})


@pytest.mark.skipif(sys.platform == "win32", reason="modes of Unix")
def test_its_files_are_its_user_s_alone_also_one_that_was_begun_otherwise(asked: Asked) -> None:
    asked.post(b"")
    asked.lines()
    [file] = asked.folder.iterdir()
    assert file.stat().st_mode & 0o777 == 0o600
    file.chmod(0o644)
    log = AuditLog(asked.folder)
    log.note({"method": "POST"})
    log.close()
    assert file.stat().st_mode & 0o777 == 0o600


def test_half_a_surrogate_pair_in_what_is_said_is_written_escaped(asked: Asked) -> None:
    asked.say(EVENTS, {"text": "\ud800"})
    assert [line["said"] for line in asked.lines()] == ["\ud800"]


def test_a_line_that_cant_be_made_is_told_as_lost_and_ends_nothing(asked: Asked) -> None:
    asked.log.note({"asked": object()})
    asked.post(b"")
    told, lost = sorted(asked.lines(), key=lambda line: "lost" in line)[-2:]
    assert (told["asked"], lost["lost"]) == (f"POST {STOP}", 1)


def test_of_what_is_said_only_that_a_jog_goes_on_is_left_out(asked: Asked) -> None:
    said = ['{"do":"stop","x":"hold"}', '{"do": "hold"}']
    asked.say(EVENTS, *({"text": text} for text in said))
    jogged = ['{"do":"run","axis":0,"x":"hold"}', '{"do":"hold","do":"run"}', '"hold"']
    asked.say(JOG, *({"text": text} for text in [*jogged, '{"do":"hold"}', '{ "do": "hold" }']))
    asked.say(EVENTS, {"bytes": b"1234"}, {"text": "a" * (LONGEST_BODY + 1)})
    *lines, binary, long = asked.lines()
    assert [line["said"] for line in lines] == said + jogged
    assert (binary["bytes"], long["said"], long["characters"]) == (4, "a" * LONGEST_BODY, LONGEST_BODY + 1)


@pytest.fixture
def held_up(monkeypatch: pytest.MonkeyPatch) -> Callable[[], None]:
    """A disk that takes until this is called."""
    goes_on = threading.Event()
    monkeypatch.setattr("os.fsync", lambda _: goes_on.wait(10))
    return goes_on.set


def test_what_waits_for_a_slow_disk_is_bounded_and_how_many_lack_is_told(
    asked: Asked, held_up: Callable[[], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is said over sockets leaves room for what is asked."""
    monkeypatch.setattr(audit, "MOST_LINES", 10)
    asked.post(b"")
    while not list(asked.folder.glob("*.jsonl")):
        pass
    asked.say(EVENTS, *({"text": str(number)} for number in range(20)))
    asked.post(b"")
    held_up()
    lines = asked.lines()
    assert [line.get("said", line["asked"]) for line in lines if "lost" not in line] == [
        f"POST {STOP}",
        *map(str, range(5)),
        f"POST {STOP}",
    ]
    assert sum(line.get("lost", 0) for line in lines) == 15


def test_of_bodies_that_wait_no_more_is_kept_than_has_room(asked: Asked, monkeypatch: pytest.MonkeyPatch) -> None:
    body = json.dumps({"axes": [{"name": "first"}, {"name": "second"}], "x": "a" * LONGEST_BODY}).encode()
    asked.post(body)
    while asked.log._kept_bytes:
        pass
    monkeypatch.setattr(audit, "MOST_KEPT", len(body) - 1)
    asked.post(body)
    kept, hashed = asked.lines()
    assert kept["designs"] == ["first", "second"]
    assert "designs" not in hashed
    assert hashed["sha256"] == kept["sha256"]
    assert asked.log._kept_bytes == 0


def test_a_body_of_very_many_values_is_hashed_and_not_read(asked: Asked, monkeypatch: pytest.MonkeyPatch) -> None:
    """To read it would hold up all threads for a second, and with them a stop."""
    monkeypatch.setattr("stepramp.json_text.json", None)  # As nothing is to be read.
    body = b"[" + b"[]," * 660_000 + b"[]]"
    asked.post(body)
    [line] = asked.lines()
    assert line["bytes"] == len(body)
    assert "designs" not in line


@pytest.mark.parametrize("axes", [5, "a", None, [5, {"name": ["a"]}, {"name": "a" * 5000}]])
def test_names_are_found_in_whatever_a_long_body_has_for_axes(asked: Asked, axes: object) -> None:
    asked.post(json.dumps({"axes": axes, "x": "a" * LONGEST_BODY}).encode())
    [line] = asked.lines()
    assert line["designs"] == (["a" * audit.LONGEST_NAME] if isinstance(axes, list) else [])
