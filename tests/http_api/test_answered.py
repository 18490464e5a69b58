"""When a stop counts as answered whose client doesn't read: over real connections."""

from __future__ import annotations

import asyncio
import itertools
import socket
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, closing, contextmanager, suppress

import pytest
import uvicorn
from starlette.types import Receive, Scope, Send
from uvicorn.server import ServerState

from event_loop import run
from stepramp.http_api import answered
from stepramp.http_api.answer import Answer
from stepramp.http_api.answered import Answered, LastResponse, until_answered
from stepramp.http_api.connections import Connection, Connections
from stepramp.http_api.request_numbers import RequestNumbering, numbering

PATIENCE_S = 15.0
STOP = b"POST /api/v1/devices/stop HTTP/1.1\r\nHost: a\r\nContent-Length: 0\r\n\r\n"
MARK = b"#" * 1000


class Stopped(Answer):
    is_held: bool


class Stops:
    """An application that stops, and a client that has yet to read what it was sent before."""

    def __init__(self) -> None:
        self.is_held = False
        self.is_asked = asyncio.Event()
        self._connections = Connections()
        numbers = itertools.count(1)
        self._now = lambda: next(numbers)
        self._made: list[Connection] = []

    @contextmanager
    def _held(self) -> Iterator[None]:
        self.is_held = True
        try:
            yield
        finally:
            self.is_held = False

    async def _stop(self, scope: Scope, receive: Receive, send: Send) -> None:
        until_answered(scope, self._held())
        self.is_asked.set()
        await LastResponse(lambda: Stopped(is_held=self.is_held))(scope, receive, send)

    def _connected(self) -> Connection:
        app = RequestNumbering(Answered(self._stop, self._now, self._connections), self._now)
        config = uvicorn.Config(app, interface="asgi3", log_level="critical")
        protocol = numbering(self._now, self._connections)
        self._made.append(protocol(config=config, server_state=ServerState(), app_state={}))
        return self._made[-1]

    @asynccontextmanager
    async def asked_behind(self, waiting_bytes: int) -> AsyncIterator[socket.socket]:
        """Yield a client that has asked to stop, and has so much unread that so many bytes wait with the server."""
        loop = asyncio.get_running_loop()
        server = await loop.create_server(self._connected, "127.0.0.1", 0)
        with closing(socket.create_connection(server.sockets[0].getsockname())) as client:
            while not self._made or self._made[0].transport is None:
                await asyncio.sleep(0)
            transport = self._made[0].transport
            while transport.get_write_buffer_size() < waiting_bytes:
                transport.write(MARK)
                await asyncio.sleep(0)
            client.sendall(STOP)
            client.setblocking(False)
            async with asyncio.timeout(PATIENCE_S):
                await self.is_asked.wait()
            yield client
        server.close()


async def told(client: socket.socket, until: bytes = b"}") -> bytes:
    """Return what a client reads, until that comes, or its end."""
    data, loop = b"", asyncio.get_running_loop()
    async with asyncio.timeout(PATIENCE_S):
        while until not in data and (more := await loop.sock_recv(client, 65_536)):
            data += more
    return data.lstrip(b"#")


@pytest.mark.parametrize("waiting_bytes", [0, 5_000, 500_000])
def test_a_stop_is_answered_as_its_answer_is_written_and_holds_until_then(waiting_bytes: int) -> None:
    async def work() -> None:
        stops = Stops()
        async with stops.asked_behind(waiting_bytes) as client:
            await asyncio.sleep(0.05)
            assert stops.is_held == (waiting_bytes > 0)
            head, _, body = (await told(client)).partition(b"\r\n\r\n")
            assert body == b'{"is_held":false}'
            assert f"content-length: {len(body)}".encode() in head.lower()
            assert not stops.is_held

    run(work())


def test_who_never_reads_has_its_connection_cut_and_no_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(answered, "UNREAD_S", 0.05)

    async def work() -> None:
        stops = Stops()
        async with stops.asked_behind(5_000) as client:
            async with asyncio.timeout(PATIENCE_S):
                while stops.is_held:
                    await asyncio.sleep(0.01)
            with suppress(ConnectionResetError):
                assert await told(client) == b""

    run(work())
