"""`stepramp stop` of servers that refuse, are slow, or know a token no more: nothing is told that isn't so."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import pytest

from client.awaited import Awaited
from client.test_urgent import HalfDeaf, half_deaf  # noqa: F401  # a fixture
from command_line.conftest import Ask
from stepramp.client import AsyncClient, Client, urgent
from stepramp.client.servers import Server, is_here
from stepramp.client.urgent import stop_until_answered
from stepramp.command_line import stop
from stepramp.errors import NoServer

Answer = Callable[[str, str], tuple[int, Any]]
"""From the end of a path below devices/, and a token, to a status and a content."""
DEVICES = [
    {"id": str(n), "port": f"port {n}", "state": "ready", "axes": [{"axis": 0, "position_steps": n}]} for n in (1, 2, 3)
]
ALL = (200, {"devices": DEVICES})
REFUSED = {"errors": [{"message": "It refuses."}]}


class Scripted(ThreadingHTTPServer):
    """Answers as it is told to."""

    daemon_threads = True

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        self.answer: Answer = lambda *_: ALL
        self.asked: list[str] = []

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_port}"


class _Handler(BaseHTTPRequestHandler):
    server: Scripted

    def do_POST(self) -> None:
        self.rfile.read(int(self.headers.get("content-length") or 0))
        what = self.path.partition("/devices/")[2]
        self.server.asked.append(what)
        status, content = self.server.answer(what, self.headers.get("authorization", "").removeprefix("Bearer "))
        text = json.dumps(content).encode()
        self.send_response(status)
        self.send_header("content-length", str(len(text)))
        self.end_headers()
        with suppress(OSError):  # Nobody waits for it any more.
            self.wfile.write(text)

    def log_message(self, *_: Any) -> None:
        pass


@pytest.fixture
def scripted() -> Iterator[Scripted]:
    with Scripted() as server:
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        yield server
        server.shutdown()
        thread.join()


def test_a_halt_that_is_slow_is_asked_for_again_and_keeps_no_other_waiting(
    scripted: Scripted, ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(urgent, "ANSWER_WITHIN_S", 0.2)
    others = threading.Event()
    missed: list[str] = []

    def answer(what: str, _: str) -> tuple[int, Any]:
        if what in ("2/halt", "3/halt") and {"2/halt", "3/halt"} <= set(scripted.asked):
            others.set()
        if what == "1/halt" and not missed:
            missed.append(what)
            others.wait(60)
            threading.Event().wait(0.4)
        return ALL if what == "stop" else (200, DEVICES[0])

    scripted.answer = answer
    told = ask(f"stop --halt --server {scripted.url}")
    assert (told.code, told.err) == (0, "")
    assert scripted.asked.count("1/halt") == 2
    assert len(told.out.splitlines()) == 3


def test_a_halt_that_is_refused_is_told(scripted: Scripted, ask: Ask) -> None:
    scripted.answer = lambda what, _: (409, REFUSED) if what == "2/halt" else ALL if what == "stop" else (200, {})
    told = ask(f"stop --halt --server {scripted.url}")
    assert (told.code, told.err) == (1, "stepramp: It refuses.\n")
    assert {"1/halt", "2/halt", "3/halt"} <= set(scripted.asked)


def test_a_server_that_ends_between_the_stop_and_a_halt_is_told_in_words(
    scripted: Scripted, ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    def ended(server: Server, device: str | None = None, *_: object, **rest: Any) -> tuple[int, bytes]:
        if device == "1":
            raise NoServer(f"No server answers at {server.url}.")
        return stop_until_answered(server, device, None, **rest)

    monkeypatch.setattr(stop, "stop_until_answered", ended)
    scripted.answer = lambda what, _: (200, DEVICES[0]) if what == "2/halt" else ALL if what == "stop" else (500, [])
    told = ask(f"stop --halt --server {scripted.url}")
    assert told.code == 1
    assert sorted(told.err.splitlines()) == [
        f"stepramp: Device 1 was stopped, and not halted: No server answers at {scripted.url}.",
        f"stepramp: Device 3 was stopped, and not halted: {scripted.url} answered with what is none.",
    ]


def test_what_one_server_refuses_is_told_with_its_name(scripted: Scripted, ask: Ask) -> None:
    scripted.answer = lambda *_: (404, {"errors": [{"message": "There is no device '9'."}]})
    told = ask(f"stop --device 9 --server {scripted.url}")
    assert (told.code, told.err) == (1, f"stepramp: NOT stopped by {scripted.url}: There is no device '9'.\n")


@pytest.mark.parametrize("content", [[], {}, None, 1, {"devices": [1]}])
def test_what_is_no_stepramp_is_told_as_such(scripted: Scripted, ask: Ask, content: object) -> None:
    scripted.answer = lambda *_: (200, content)
    told = ask(f"stop --server {scripted.url}")
    words = f"NOT stopped by {scripted.url}: what answers there is no StepRamp."
    assert (told.code, told.err) == (3, f"stepramp: {words}\n")


def test_an_old_link_stops_all_the_same_where_the_server_has_left_a_note(
    scripted: Scripted, ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    scripted.answer = lambda _, token: ALL if token == "new" else (401, REFUSED)
    monkeypatch.setattr(stop, "running", lambda: [Server("http://127.0.0.1:1", "new"), Server(scripted.url, "new")])
    told = ask(f"stop --server {scripted.url}?token=old")
    assert (told.code, told.err, len(told.out.splitlines())) == (0, "", 3)
    monkeypatch.setattr(stop, "running", list)
    told = ask(f"stop --server {scripted.url}?token=old")
    assert (told.code, told.out) == (3, "")
    assert told.err.startswith(f"stepramp: NOT stopped by {scripted.url}: It refuses.\n")
    assert "cut the motor's power" in told.err
    # The virtual controller of this program is another one.
    told = ask(f"stop --port sim:// --server {scripted.url}?token=old")
    assert (told.code, told.out) == (3, "")
    assert "Nothing at sim:// was stopped" in told.err


def test_the_token_of_another_server_with_the_same_port_stops_nothing_and_is_told_nobody_elsewhere(
    scripted: Scripted, ask: Ask, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown: list[str] = []

    def answer(_: str, token: str) -> tuple[int, Any]:
        shown.append(token)
        return 401, REFUSED

    scripted.answer = answer
    port = scripted.server_port
    monkeypatch.setattr(stop, "running", lambda: [Server(f"http://127.0.0.2:{port}", "another's")])
    told = ask(f"stop --server {scripted.url}?token=old")
    assert (told.code, told.out, shown) == (3, "", ["old", "another's"])
    assert told.err.startswith(f"stepramp: NOT stopped by {scripted.url}: It refuses.\n")
    # Elsewhere it isn't even tried.
    monkeypatch.setattr(stop, "is_here", lambda server: server.place[0] != "127.0.0.1")
    shown.clear()
    assert ask(f"stop --server {scripted.url}?token=old").code == 3
    assert shown == ["old"]


@pytest.mark.parametrize(("host", "here"), [("127.0.0.1", True), ("localhost", True), ("192.0.2.7", False)])
def test_what_is_of_this_machine_is_known(host: str, here: bool) -> None:
    assert is_here(Server(f"http://{host}:8000")) == here


@pytest.mark.parametrize(("status", "content"), [(502, "<html>"), (503, {}), (504, None)])
def test_a_server_behind_a_proxy_is_asked_until_it_is_back(
    scripted: Scripted, ask: Ask, status: int, content: object
) -> None:
    scripted.answer = lambda *_: (status, content) if len(scripted.asked) < 3 else ALL
    told = ask(f"stop --server {scripted.url}")
    assert (told.code, len(told.out.splitlines()), len(scripted.asked)) == (0, 3, 3)
    assert told.err.count(f"a proxy answers in its place, with {status}") == 1


def test_clients_ask_a_server_behind_a_proxy_until_it_is_back(scripted: Scripted) -> None:
    scripted.answer = lambda *_: (502, "<html>") if len(scripted.asked) % 3 else (200, {"devices": []})
    with Client(scripted.url) as client:
        assert client.stop_all().devices == []
    awaited = Awaited(AsyncClient(scripted.url))
    assert awaited.stop_all().devices == []
    awaited.end()
    assert len(scripted.asked) == 6


def test_why_it_can_t_be_asked_is_told(half_deaf: HalfDeaf) -> None:  # noqa: F811
    def tell(why: str) -> None:
        raise InterruptedError(why)

    for url in ("https" + half_deaf.url[4:], "http://nowhere.invalid"):
        with pytest.raises(InterruptedError, match=r"\w"):
            stop_until_answered(Server(url), tell=tell)


def test_an_answer_is_waited_for_twice_as_long_each_time(monkeypatch: pytest.MonkeyPatch) -> None:
    waited: list[float] = []

    def ask_to_stop(*_: object, within_s: float, **__: object) -> tuple[int, bytes]:
        waited.append(within_s)
        if len(waited) == 6:
            return 200, b""
        raise TimeoutError

    monkeypatch.setattr(urgent, "ask_to_stop", ask_to_stop)
    monkeypatch.setattr(urgent, "PAUSE_S", 0)
    assert stop_until_answered(Server("http://a")) == (200, b"")
    assert waited == [4, 8, 16, 32, 32, 32]
