"""A stop waits for nothing else, and is asked for until it is answered."""

from __future__ import annotations

import json
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import pytest

from client.awaited import Awaited
from designs import document
from stepramp.client import AsyncClient, Client
from stepramp.client.servers import Server
from stepramp.client.urgent import stop_until_answered
from stepramp.errors import NoServer


class HalfDeaf(ThreadingHTTPServer):
    """Answers nothing but stops, and of those not the first ones."""

    daemon_threads = True

    def __init__(self, unanswered: int) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        self.unanswered = unanswered
        self.asked: list[str] = []
        self.devices: list[dict[str, Any]] = []
        self.errors: list[dict[str, Any]] = []
        """What it tells as stopped."""
        self.is_busy = threading.Event()
        self.is_over = threading.Event()

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_port}"


class _Handler(BaseHTTPRequestHandler):
    server: HalfDeaf

    def do_POST(self) -> None:
        self.server.asked.append(self.path)
        if not self.path.endswith("stop"):
            self.server.is_busy.set()
            self.server.is_over.wait(60)
            return
        if self.server.unanswered:
            self.server.unanswered -= 1
            return
        known = {"devices": self.server.devices} | ({"errors": self.server.errors} if self.server.errors else {})
        content = json.dumps(known).encode()
        self.send_response(200)
        self.send_header("content-length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *_: Any) -> None:
        pass


@pytest.fixture
def half_deaf() -> Iterator[HalfDeaf]:
    with HalfDeaf(unanswered=2) as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        yield server
        server.is_over.set()
        server.shutdown()
        thread.join()


def test_a_stop_passes_a_request_that_hangs_and_is_asked_again(half_deaf: HalfDeaf) -> None:
    with Client(half_deaf.url) as client:

        def plan() -> None:
            with pytest.raises(NoServer):
                client.profile(document())

        hanging = threading.Thread(target=plan)
        hanging.start()
        assert half_deaf.is_busy.wait(60)
        assert client.stop_all().devices == []
        half_deaf.is_over.set()
        hanging.join()
    assert half_deaf.asked.count("/api/v1/devices/stop") == 3


def test_a_stop_that_is_awaited_is_asked_again_too(half_deaf: HalfDeaf) -> None:
    client = Awaited(AsyncClient(half_deaf.url))
    assert client.stop_all().devices == []
    client.end()
    assert len(half_deaf.asked) == 3


def test_the_stop_of_the_command_line_is_asked_again_too(half_deaf: HalfDeaf) -> None:
    status, content = stop_until_answered(Server(half_deaf.url))
    assert (status, json.loads(content), len(half_deaf.asked)) == (200, {"devices": []}, 3)
    half_deaf.unanswered = 10**6
    with pytest.raises(NoServer, match="has not answered"):
        stop_until_answered(Server(half_deaf.url), within_s=0.0)
