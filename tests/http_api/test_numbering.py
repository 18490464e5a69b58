"""Requests are as old as their first byte: over real connections to the server's process."""

from __future__ import annotations

import asyncio
import itertools
import json
import socket
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager
from functools import partial

import pytest
import uvicorn
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.server import ServerState

from designs import document
from event_loop import run
from server_process import ServerProcess
from stepramp.http_api.answered import AT_LAST, Answered
from stepramp.http_api.connections import Connections
from stepramp.http_api.request_numbers import RequestNumbering, numbering

PATIENCE_S = 15.0


@pytest.fixture(scope="module")
def server() -> Iterator[ServerProcess]:
    with ServerProcess(8950) as server:
        server.ask("POST", "devices", {"port": "sim://"})
        server.ask("POST", "devices/1/push", {"design": document(), "mode": "try"})
        yield server


def request(server: ServerProcess, route: str, body: object) -> bytes:
    text = json.dumps(body).encode()
    head = f"POST /api/v1/{route} HTTP/1.1\r\nHost: 127.0.0.1:{server.address.port}\r\n"
    head += f"Content-Type: application/json\r\nContent-Length: {len(text)}\r\n\r\n"
    return head.encode() + text


def answers(connection: socket.socket, count: int) -> bytes:
    """Return what comes until so many answers have begun, and the last of them has come whole."""
    data = b""
    while data.count(b"HTTP/1.1 ") < count or not data.rstrip().endswith((b"}", b"]")):
        data += connection.recv(65_536)
    return data


@pytest.fixture
def connection(server: ServerProcess) -> Iterator[socket.socket]:
    with socket.create_connection((server.address.hostname, server.address.port), timeout=60) as connection:
        yield connection


def test_a_move_behind_another_request_of_its_connection(server: ServerProcess, connection: socket.socket) -> None:
    slow = {"design": document(move__steps=3_000_000), "max_points": 100}
    move = request(server, "devices/1/move", {"by_steps": 50})
    connection.sendall(request(server, "profile", slow) + move)
    server.ask("POST", "devices/stop")
    assert b"A stop came first" in answers(connection, 2)
    connection.sendall(move)
    assert b"200 OK" in answers(connection, 1)
    server.ask("POST", "devices/1/halt")


def test_a_move_whose_head_comes_in_drops(server: ServerProcess, connection: socket.socket) -> None:
    move = request(server, "devices/1/move", {"by_steps": 50})
    connection.sendall(move[:40])
    while not server.ask("GET", "devices")["devices"]:
        pass
    server.ask("POST", "devices/1/stop")
    connection.sendall(move[40:])
    assert b"A stop came first" in answers(connection, 1)
    connection.sendall(move)
    assert b"200 OK" in answers(connection, 1)
    server.ask("POST", "devices/1/halt")


class Numbered:
    """One connection to an application that notes the number of each request, by its path, and answers at once.

    /slow is answered when that is wanted, without a look at its body.
    """

    def __init__(self) -> None:
        self.connections = Connections()
        self.order = itertools.count(1)
        self.numbers: dict[str, int] = {}
        self.answer_slow = asyncio.Event()
        self.served: ASGIApp = self.app

    async def app(self, scope: Scope, receive: Receive, send: Send) -> None:
        self.numbers[scope["path"]] = scope["state"]["stepramp.request_number"]
        if scope["path"] == "/slow":
            await self.answer_slow.wait()
        await PlainTextResponse("answered")(scope, receive, send)

    @asynccontextmanager
    async def connected(self) -> AsyncIterator[tuple[H11Protocol, asyncio.StreamReader, asyncio.StreamWriter]]:
        """Yield the server's end of a connection, and the client's."""
        config = uvicorn.Config(self.served, interface="asgi3", log_level="critical")
        made = numbering(self.now, self.connections)
        here, there = socket.socketpair()
        _, protocol = await asyncio.get_running_loop().connect_accepted_socket(
            lambda: made(config=config, server_state=ServerState(), app_state={}), there
        )
        reader, writer = await asyncio.open_connection(sock=here)
        try:
            yield protocol, reader, writer
        finally:
            writer.close()
            protocol.transport.close()
            await asyncio.sleep(0)

    def now(self) -> int:
        return next(self.order)

    async def until(self, condition: Callable[[], object]) -> None:
        async with asyncio.timeout(PATIENCE_S):
            while not condition():
                await asyncio.sleep(0)


def get(path: str, body: bytes = b"") -> bytes:
    return f"GET {path} HTTP/1.1\r\nHost: a\r\nContent-Length: {len(body)}\r\n\r\n".encode() + body


def test_what_waits_unread_behind_others_is_as_old_as_they_are() -> None:
    """The second request is answered in the same turn in which the first one ends: only then the third is read."""

    async def work() -> None:
        numbered = Numbered()
        async with numbered.connected() as (protocol, reader, writer):
            writer.write(get("/slow"))
            await numbered.until(lambda: "/slow" in numbered.numbers)
            writer.write(get("/second"))
            await numbered.until(lambda: protocol.flow.read_paused)
            writer.write(get("/third"))
            stopped = next(numbered.order)
            numbered.answer_slow.set()
            await numbered.until(lambda: "/third" in numbered.numbers)
            assert max(numbered.numbers.values()) < stopped
            for _ in range(3):
                await reader.readuntil(b"answered")
            assert not protocol.app_state
            writer.write(get("/anew"))
            await numbered.until(lambda: "/anew" in numbered.numbers)
            assert numbered.numbers["/anew"] > stopped

    run(work())


def test_what_waits_unread_behind_a_body_that_nobody_wants_is_as_old_as_that() -> None:
    async def work() -> None:
        numbered = Numbered()
        async with numbered.connected() as (protocol, _, writer):
            body = b" " * 110_000
            writer.write(get("/slow", body)[:-10_000])
            await numbered.until(lambda: protocol.flow.read_paused)
            writer.write(body[:10_000] + get("/third"))
            stopped = next(numbered.order)
            numbered.answer_slow.set()
            await numbered.until(lambda: "/third" in numbered.numbers)
            assert numbered.numbers["/third"] < stopped
            await numbered.until(lambda: not protocol.app_state)

    run(work())


def test_a_request_that_waits_for_nothing_has_a_number_of_its_own() -> None:
    async def work() -> None:
        numbered = Numbered()
        async with numbered.connected() as (_, reader, writer):
            for path in ("/a", "/b"):
                stopped = next(numbered.order)
                writer.write(get(path))
                await reader.readuntil(b"answered")
                assert numbered.numbers[path] > stopped

    run(work())


STOP = "/api/v1/devices/stop"


def test_what_comes_in_unread_before_a_stop_is_answered_is_as_old_as_the_stop() -> None:
    """However long the machine is busy with others after the server has looked for the last time."""

    async def work() -> None:
        numbered = Numbered()
        stops: list[int] = []

        async def app(scope: Scope, receive: Receive, send: Send) -> None:
            if scope["path"] == STOP:
                stops.append(numbered.now())
                other.write(get("/move"))
            await numbered.app(scope, receive, send)

        numbered.served = RequestNumbering(Answered(app, numbered.now, numbered.connections), numbered.now)
        async with numbered.connected() as (_, reader, writer), numbered.connected() as (moving, told, other):
            writer.write(get(STOP).replace(b"GET", b"POST"))
            await reader.readuntil(b"answered")
            writer.write(get("/own"))
            await told.readuntil(b"answered")
            await reader.readuntil(b"answered")
            assert numbered.numbers[STOP] <= numbered.numbers["/move"] < stops[0] < numbered.numbers["/own"]
            # What is asked after that is new again.
            assert not moving.app_state
            stopped = numbered.now()
            other.write(get("/anew"))
            await told.readuntil(b"answered")
            assert numbered.numbers["/anew"] > stopped

    run(work())


def test_a_stop_over_a_websocket_counts_from_the_instant_in_which_its_answer_is_written() -> None:
    async def work() -> None:
        numbered = Numbered()
        stops: list[int] = []
        sent: list[Message] = []

        def answer() -> str:
            other.write(get("/move"))
            stops.append(numbered.now())
            return "stopped"

        async def app(_: Scope, __: Receive, send: Send) -> None:
            await send({"type": "websocket.send", AT_LAST: answer})

        async def send(message: Message) -> None:
            sent.append(message)

        async with numbered.connected() as (_, told, other):
            await Answered(app, numbered.now, numbered.connections)({"type": "websocket"}, unheard, send)
            await told.readuntil(b"answered")
        assert sent == [{"type": "websocket.send", "text": "stopped"}]
        assert numbered.numbers["/move"] < stops[0]

    run(work())


@asynccontextmanager
async def listening(numbered: Numbered, accepted_a_turn: int = 4) -> AsyncIterator[Callable[[str], socket.socket]]:
    """Yield what connects, at once, and asks for a path, if for any."""
    config = uvicorn.Config(numbered.served, interface="asgi3", log_level="critical")
    made = numbering(numbered.now, numbered.connections)
    ours = socket.create_server(("127.0.0.1", 0))
    listener = await asyncio.get_running_loop().create_server(
        lambda: made(config=config, server_state=ServerState(), app_state={}), sock=ours, backlog=accepted_a_turn
    )
    ours.listen(100)
    numbered.connections.listen(ours)
    opened: list[socket.socket] = []

    def connect(path: str = "") -> socket.socket:
        opened.append(socket.create_connection(ours.getsockname()))
        opened[-1].sendall(get(path) if path else b"")
        return opened[-1]

    try:
        yield connect
    finally:
        listener.close()
        for each in opened:
            each.close()
        await asyncio.sleep(0.01)


@pytest.mark.parametrize("ahead", [0, 1, 3, 4, 5, 40])
def test_what_waits_to_be_accepted_when_a_stop_is_answered_is_as_old_as_the_stop(ahead: int) -> None:
    """A request over a new connection, sent before the answer, however many turns it takes until it is accepted."""

    async def work() -> None:
        numbered = Numbered()
        stops: list[int] = []

        async def app(scope: Scope, receive: Receive, send: Send) -> None:
            if scope["path"] == STOP:
                for _ in range(ahead):
                    connect("")
                connect("/move")
                stops.append(numbered.now())
            await numbered.app(scope, receive, send)

        numbered.served = RequestNumbering(Answered(app, numbered.now, numbered.connections), numbered.now)
        async with listening(numbered) as connect:
            connect("").sendall(get(STOP).replace(b"GET", b"POST"))
            await numbered.until(lambda: "/move" in numbered.numbers)
            assert numbered.numbers["/move"] < stops[0]
            connect("/anew")
            await numbered.until(lambda: "/anew" in numbered.numbers)
            assert numbered.numbers["/anew"] > stops[0]

    run(work())


@pytest.mark.parametrize("turns", range(6))
def test_what_is_being_accepted_when_a_stop_is_answered_is_as_old_as_the_stop(turns: int) -> None:
    """In whichever turn of the loop; and what connects in the very turn of the answer is new."""

    async def work() -> None:
        numbered = Numbered()
        async with listening(numbered) as connect:
            before = numbered.now()
            connect("/move")
            for _ in range(turns):
                await asyncio.sleep(0)
            stopped = numbered.now()
            numbered.connections.make_unread_as_old_as(before)
            if turns > 1:
                # Nothing waits to be accepted any more.
                connect("/anew")
                await numbered.until(lambda: "/anew" in numbered.numbers)
                assert numbered.numbers["/anew"] > stopped
            await numbered.until(lambda: "/move" in numbered.numbers)
            assert numbered.numbers["/move"] < stopped

    run(work())


@pytest.mark.parametrize("is_answered_first", [False, True])
def test_what_came_with_the_end_of_a_handshake_when_a_stop_is_answered_is_as_old_as_the_stop(
    is_answered_first: bool,
) -> None:
    """It is read, with that, before the connection counts as made; before the hello nobody sends a request."""

    async def work() -> None:
        numbered = Numbered()
        config = uvicorn.Config(numbered.app, interface="asgi3", log_level="critical")
        config.load()
        config.ssl_certfile = "a certificate"  # It says no more than that connections are encrypted.
        async with listening(numbered):
            before = numbered.now()
            stop = partial(numbered.connections.make_unread_as_old_as, before)
            if is_answered_first:
                stop()
            protocol = numbering(numbered.now, numbered.connections)(
                config=config, server_state=ServerState(), app_state={}
            )
            if not is_answered_first:
                stop()
            here, there = socket.socketpair()
            await asyncio.get_running_loop().connect_accepted_socket(lambda: protocol, there)
            here.sendall(get("/move"))
            await numbered.until(lambda: "/move" in numbered.numbers)
            assert (numbered.numbers["/move"] == before) is not is_answered_first
            protocol.transport.close()
            here.close()

    run(work())


def test_what_waits_to_be_accepted_when_several_stops_are_answered_is_as_old_as_the_first() -> None:
    """The first may have been of one device, the second of another one."""

    async def work() -> None:
        numbered = Numbered()
        async with listening(numbered, accepted_a_turn=1) as connect:
            first = numbered.now()
            for _ in range(10):
                connect("")
            connect("/move")
            numbered.connections.make_unread_as_old_as(first)
            await asyncio.sleep(0)
            second = numbered.now()
            connect("/between")
            numbered.connections.make_unread_as_old_as(second)
            last = numbered.now()
            await numbered.until(lambda: "/between" in numbered.numbers)
            assert (numbered.numbers["/move"], numbered.numbers["/between"] < last) == (first, True)

    run(work())


def test_however_many_keep_connecting_no_more_are_as_old_as_a_stop_than_can_have_waited(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    async def work() -> None:
        monkeypatch.setattr("stepramp.http_api.connections.MOST_LATE", 10)
        numbered = Numbered()
        async with listening(numbered, accepted_a_turn=1) as connect:
            before = numbered.now()
            for number in range(20):
                connect(f"/{number}")
            numbered.connections.make_unread_as_old_as(before)
            await numbered.until(lambda: len(numbered.numbers) == 20)
            assert [numbered.numbers[f"/{number}"] == before for number in range(20)] == [True] * 10 + [False] * 10

    run(work())


async def unheard() -> Message:
    raise AssertionError
