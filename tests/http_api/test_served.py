"""The real server in a process of its own: what becomes of large bodies and messages, and of its memory."""

from __future__ import annotations

import http.client
import json
import select
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack, closing
from pathlib import Path

import pytest
from websockets.exceptions import ConnectionClosedError
from websockets.sync.client import ClientConnection, connect

from designs import document
from stepramp.http_api.bodies import MOST_BYTES, MOST_TOGETHER_BYTES

TIMEOUT_S = 60
MEGABYTE = 1 << 20
JSON = {"content-type": "application/json"}


class Served:
    """A server that runs, and where."""

    def __init__(self) -> None:
        command = [sys.executable, "-m", "stepramp", "--port", "8950", "--no-browser"]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        assert self.process.stdout is not None
        self.host = self.process.stdout.readline().split("//")[1].split("/")[0]

    def post(self, route: str, body: object, headers: dict[str, str] = JSON) -> tuple[int, bytes]:
        with closing(http.client.HTTPConnection(self.host, timeout=TIMEOUT_S)) as connection:
            connection.request("POST", f"/api/v1/{route}", body, headers)
            answer = connection.getresponse()
            return answer.status, answer.read()

    def memory_bytes(self) -> int:
        status = Path(f"/proc/{self.process.pid}/status").read_text(encoding="utf-8")
        return 1024 * int(status.split("VmRSS:")[1].split()[0])


@pytest.fixture(scope="module")
def served() -> Iterator[Served]:
    served = Served()
    yield served
    served.process.terminate()
    _, complaints = served.process.communicate(timeout=TIMEOUT_S)
    assert complaints == ""


def chunks(count: int) -> Iterator[bytes]:
    for _ in range(count):
        yield b"[" * MEGABYTE


def unknown_fields() -> bytes:
    wrong = {"design": document()} | {f"{number:045}": 0 for number in range(38_000)}
    body = json.dumps(wrong, separators=(",", ":")).encode()
    assert MOST_BYTES * 0.9 < len(body) < MOST_BYTES
    return body


def test_a_body_that_is_too_large_is_refused_whether_its_length_is_known_or_not(served: Served) -> None:
    for body in (b"[" * 20 * MEGABYTE, chunks(20)):
        status, answer = served.post("profile", body)
        assert status == 413
        assert "up to 2,000,000 bytes" in json.loads(answer)["errors"][0]["message"]


def test_memory_falls_back_after_large_bodies(served: Served) -> None:
    served.post("profile", unknown_fields())
    before = served.memory_bytes()
    for _ in range(3):
        assert served.post("profile", chunks(30))[0] == 413
        assert served.post("profile", unknown_fields())[0] == 422
        assert served.post("profile", b"[" * (MOST_BYTES - 1))[0] == 422
        assert served.post("table/play", b'{"targets": [' + b"{}," * 600_000 + b"{}]}")[0] == 422
    assert served.memory_bytes() < before + 150 * MEGABYTE


def test_others_are_answered_while_large_bodies_are_refused(served: Served) -> None:
    body, ended = unknown_fields(), threading.Event()

    def refuse_some() -> None:
        for _ in range(10):
            assert served.post("profile", body)[0] == 422
        ended.set()

    large = threading.Thread(target=refuse_some)
    large.start()
    answered = 0
    while not ended.is_set():
        assert served.post("devices/stop", None, {})[0] == 200
        answered += 1
    large.join()
    assert answered >= 10


def test_unfinished_bodies_take_no_more_memory_than_there_is_for_them(served: Served) -> None:
    """Of bodies that never end only so many are kept; those beyond are refused, and small ones never."""
    fitting = MOST_TOGETHER_BYTES // MOST_BYTES
    host, _, port = served.host.partition(":")
    head = f"POST /api/v1/profile HTTP/1.1\r\nHost: {served.host}\r\nContent-Type: application/json\r\n"
    head += f"Content-Length: {MOST_BYTES}\r\n\r\n"
    large = json.dumps({"design": document()}).encode() + b" " * (MOST_BYTES // 2)
    with ExitStack() as open_ends:
        connections = [
            open_ends.enter_context(socket.create_connection((host, int(port)), timeout=TIMEOUT_S))
            for _ in range(fitting + 4)
        ]
        for connection in connections:
            connection.sendall(head.encode() + b" " * (MOST_BYTES - 1))
        refused: set[socket.socket] = set()
        while len(refused) < 4:
            refused.update(select.select([each for each in connections if each not in refused], [], [], TIMEOUT_S)[0])
        assert all(b"503 Service Unavailable" in each.recv(1000) for each in refused)
        assert served.post("profile", json.dumps({"design": document()}))[0] == 200
    while served.post("profile", large)[0] != 200:
        pass


def refused_of(socket: ClientConnection) -> None:
    """Say too much, and read on; it may be refused before all of it was sent."""
    socket.send("x" * (MOST_BYTES + 1))
    list(iter(lambda: socket.recv(TIMEOUT_S), None))


@pytest.mark.parametrize("path", ["devices/events", "curves/socket"])
def test_a_message_that_is_too_large_closes_the_socket_and_says_so(served: Served, path: str) -> None:
    with (
        connect(f"ws://{served.host}/api/v1/{path}", max_size=None) as socket,
        pytest.raises(ConnectionClosedError) as caught,
    ):
        refused_of(socket)
    assert caught.value.rcvd is not None
    assert caught.value.rcvd.code == 1009


def test_a_message_that_is_just_not_too_large_is_answered(served: Served) -> None:
    with connect(f"ws://{served.host}/api/v1/curves/socket", max_size=None) as socket:
        socket.send("x" * MOST_BYTES)
        assert "errors" in json.loads(socket.recv(TIMEOUT_S))
