"""Connections: whoever opens how many ever, the next one is accepted, and with it a stop."""

from __future__ import annotations

import asyncio
import shutil
import socket
import ssl
import subprocess
import sys
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import ExitStack, asynccontextmanager
from pathlib import Path

import pytest
import uvicorn
from starlette.responses import PlainTextResponse
from starlette.types import Receive, Scope, Send
from uvicorn.server import ServerState

from event_loop import run
from server_process import PATIENCE_S, ServerProcess
from stepramp.errors import NotFound
from stepramp.http_api.connections import DESCRIPTORS, STEADY_BYTES, Connection, Connections, Stage
from stepramp.http_api.errors import error_response
from stepramp.http_api.request_numbers import numbering
from stepramp.http_api.server import Sockets
from tools import require

REQUEST = b"GET /quick HTTP/1.1\r\nHost: a\r\n\r\n"
POST = b"POST /quick HTTP/1.1\r\nHost: a\r\nContent-Length: 2\r\n\r\n{}"
UPGRADE = (
    b"GET /socket HTTP/1.1\r\nHost: a\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    b"Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n\r\n"
)
UNFINISHED = (b"G", REQUEST[:-2], b"POST /slow HTTP/1.1\r\nHost: a\r\nContent-Length: 9\r\n\r\nbody")
FOREVER_S = 3600.0


class Client:
    """A client's end of a connection."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader, self.writer = reader, writer

    async def is_answered(self) -> bool:
        """Whether it gets an answer, and not its end."""
        return b"answered" in await asyncio.wait_for(self.reader.read(1000), PATIENCE_S)

    async def has_ended(self) -> bool:
        """Wait for its end."""
        try:
            return await asyncio.wait_for(self.reader.read(1), PATIENCE_S) == b""
        except ConnectionError:
            return True


class Served:
    """An application behind so many connections; /slow is answered when that is wanted."""

    def __init__(self, connections: Connections) -> None:
        self.connections = connections
        self.asked = 0
        self.answer_slow = asyncio.Event()
        self.clients: list[Client] = []
        self.taken: list[Connection] = []

    def let_time_pass(self) -> None:
        """Have all that is open wait since long ago."""
        for each in self.taken:
            each._waits_since_s -= FOREVER_S

    async def read(self, client: Client) -> None:
        """Wait until the begin of a request that a client has sent is read."""
        async with asyncio.timeout(PATIENCE_S):
            while self.taken[self.clients.index(client)].stage is not Stage.BEGUN:
                await asyncio.sleep(0)

    async def app(self, scope: Scope, receive: Receive, send: Send) -> None:
        self.asked += 1
        if scope["type"] == "websocket":
            await error_response(NotFound("answered: there is no such socket"))(scope, receive, send)
            return
        if scope["path"] == "/slow":
            await self.answer_slow.wait()
        while (await receive()).get("more_body"):
            pass
        await PlainTextResponse("answered")(scope, receive, send)

    @asynccontextmanager
    async def listening(self, cert: Path | None = None) -> AsyncIterator[Callable[[bytes], Awaitable[Client]]]:
        """Yield what opens one more connection, and sends something over it, which the server has then read.

        cert: of a certificate with its key; None: over plain TCP.
        """
        config = uvicorn.Config(self.app, interface="asgi3", log_config=None, ws=Sockets)
        made, state = numbering(lambda: 1, self.connections), ServerState()

        def protocol() -> asyncio.Protocol:
            self.taken.append(made(config=config, server_state=state, app_state={}))
            return self.taken[-1]

        async def opened(sent: bytes) -> Client:
            trusting = None if cert is None else ssl.create_default_context(cafile=cert)
            reader, writer = await asyncio.open_connection(*listener.sockets[0].getsockname(), ssl=trusting)
            client = Client(reader, writer)
            self.clients.append(client)
            writer.write(sent)
            async with asyncio.timeout(PATIENCE_S):
                while len(self.taken) < len(self.clients) or (sent != b"") is self.taken[-1]._is_silent:
                    await asyncio.sleep(0)
            return client

        shown = None if cert is None else ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        if shown is not None:
            shown.load_cert_chain(cert)
        listener = await asyncio.get_running_loop().create_server(protocol, "127.0.0.1", 0, ssl=shown)
        try:
            yield opened
        finally:
            listener.close()
            self.answer_slow.set()
            for client in self.clients:
                client.writer.close()
            while state.connections:
                await asyncio.sleep(0)


def test_those_that_never_sent_anything_end_first_the_oldest_before_the_others() -> None:
    async def work() -> None:
        served = Served(Connections(most=4, heard_within_s=FOREVER_S, new_s=0.0))
        async with served.listening() as opened:
            begun, first, second = await opened(REQUEST[:9]), await opened(b""), await opened(b"")
            slow = await opened(REQUEST.replace(b"quick", b"slow"))
            assert await (await opened(REQUEST)).is_answered()
            assert await first.has_ended()
            assert await (await opened(REQUEST)).is_answered()
            assert await second.has_ended()
            # Now it is the turn of those that were answered, then of one that doesn't come to its end.
            for _ in range(3):
                await opened(REQUEST[:9])
            assert await begun.has_ended()
            served.answer_slow.set()
            assert await slow.is_answered()

    run(work())


@pytest.mark.parametrize("begin", [b"", REQUEST[:9], POST[:-1]])
def test_one_that_has_just_come_outlives_those_that_do_nothing_for_longer(begin: bytes) -> None:
    """It may be a stop whose bytes weren't read yet, or come in several parts."""

    async def work() -> None:
        served = Served(Connections(most=4, heard_within_s=FOREVER_S, new_s=FOREVER_S))
        async with served.listening() as opened:
            silent, half = await opened(b""), await opened(REQUEST[:9])
            at_rest = await opened(REQUEST)
            assert await at_rest.is_answered()
            served.let_time_pass()
            stop = await opened(begin)
            for older in (silent, at_rest, half):
                await opened(REQUEST[:9])
                assert await older.has_ended()
            stop.writer.write(POST[len(begin) :] if begin == POST[:-1] else REQUEST[len(begin) :])
            assert await stop.is_answered()

    run(work())


def test_of_those_that_have_just_come_the_one_that_waits_longest_ends_first() -> None:
    """And they end before those that are being served."""

    async def work() -> None:
        served = Served(Connections(most=3, heard_within_s=FOREVER_S, new_s=FOREVER_S))
        async with served.listening() as opened:
            slow, kept = await opened(REQUEST.replace(b"quick", b"slow")), await opened(REQUEST)
            assert await kept.is_answered()
            begun = await opened(REQUEST[:9])
            kept.writer.write(REQUEST[:9])
            await served.read(kept)
            await opened(b"")
            assert await begun.has_ended()
            kept.writer.write(REQUEST[9:])
            assert await kept.is_answered()
            served.answer_slow.set()
            assert await slow.is_answered()

    run(work())


def test_one_that_was_answered_just_now_outlives_those_that_do_nothing_for_longer() -> None:
    """Over it a stop came."""

    async def work() -> None:
        served = Served(Connections(most=3, heard_within_s=FOREVER_S, new_s=FOREVER_S))
        async with served.listening() as opened:
            silent, kept = await opened(b""), await opened(REQUEST)
            assert await kept.is_answered()
            for _ in range(2):
                await opened(b"")
            assert await silent.has_ended()
            kept.writer.write(REQUEST)
            assert await kept.is_answered()

    run(work())


def test_one_at_which_bytes_wait_to_be_read_outlives_all_that_are_not_served() -> None:
    """They may be a stop; it would be lost unread."""

    async def work() -> None:
        served = Served(Connections(most=3, heard_within_s=FOREVER_S, new_s=FOREVER_S))
        async with served.listening() as opened:
            kept = await opened(REQUEST)
            assert await kept.is_answered()
            served.let_time_pass()
            # As if the loop had no turn yet in which it is read.
            unread = served.taken[0].transport
            unread.pause_reading()
            kept.writer.write(REQUEST)
            for _ in range(4):
                await opened(b"")
            unread.resume_reading()
            assert await kept.is_answered()

    run(work())


def test_one_is_accepted_although_all_are_being_served() -> None:
    async def work() -> None:
        served = Served(Connections(most=3, heard_within_s=FOREVER_S))
        async with served.listening() as opened:
            slow = [await opened(REQUEST.replace(b"quick", b"slow")) for _ in range(3)]
            assert await (await opened(REQUEST)).is_answered()
            assert await slow[0].has_ended()
            served.answer_slow.set()
            assert await slow[2].is_answered()

    run(work())


@pytest.mark.parametrize("sent", [b"", *UNFINISHED])
def test_what_does_not_come_to_its_end_ends(sent: bytes) -> None:
    async def work() -> None:
        served = Served(Connections(heard_within_s=0.05))
        async with served.listening() as opened:
            slow = await opened(REQUEST.replace(b"quick", b"slow"))
            assert await (await opened(sent)).has_ended()
            # One that has come whole may take as long as it takes.
            served.answer_slow.set()
            assert await slow.is_answered()

    run(work())


def test_a_body_may_take_long_as_long_as_it_comes_steadily() -> None:
    async def work() -> None:
        served = Served(Connections(heard_within_s=FOREVER_S))
        async with served.listening() as opened:
            size = 3 * STEADY_BYTES
            head = b"POST /quick HTTP/1.1\r\nHost: a\r\nContent-Length: %d\r\n\r\n" % size
            client = await opened(head)
            [taken] = served.taken
            for _ in range(2):
                served.let_time_pass()
                client.writer.write(b"x" * STEADY_BYTES)
                async with asyncio.timeout(PATIENCE_S):
                    while taken._heard_bytes < STEADY_BYTES:
                        await asyncio.sleep(0)
                taken._end_when_late()
                assert not taken.transport.is_closing()
            taken._end_when_late()
            assert await client.has_ended()

    run(work())


def test_over_tls_nothing_is_made_of_who_has_gone(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """Neither by the clock that ends what is late, nor as one more comes than there may be."""
    require(*([] if shutil.which("openssl") else ["openssl"]))
    cert = tmp_path / "cert.pem"
    command = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "1", "-keyout", cert, "-out"]
    about = [tmp_path / "only.pem", "-subj", "/CN=a", "-addext", "subjectAltName=IP:127.0.0.1"]
    subprocess.run([*command, *about], check=True, capture_output=True)
    cert.write_text(cert.read_text() + (tmp_path / "only.pem").read_text())

    async def work() -> None:
        mistakes: list[dict[str, object]] = []
        asyncio.get_running_loop().set_exception_handler(lambda _, told: mistakes.append(told))
        served = Served(Connections(most=2, heard_within_s=0.3))
        async with served.listening(cert) as opened:
            for _ in range(2):
                gone = await opened(UPGRADE)
                assert await gone.is_answered()
                gone.writer.close()
                served.taken[-1].transport.close()
            await asyncio.sleep(0.4)
            assert await (await opened(REQUEST)).is_answered()
        assert mistakes == []

    run(work())
    assert [each.getMessage() for each in caplog.records if each.levelname == "ERROR"] == []


def test_a_socket_that_is_refused_is_no_mistake(caplog: pytest.LogCaptureFixture) -> None:
    async def work() -> None:
        served = Served(Connections())
        async with served.listening() as opened:
            refused = await opened(UPGRADE)
            assert await refused.is_answered()
            assert await refused.has_ended()

    run(work())
    assert caplog.records == []


@pytest.mark.skipif(sys.platform != "linux", reason="limits of another process")
@pytest.mark.parametrize("sent", [b"", *UNFINISHED])
def test_a_stop_is_answered_however_many_connections_there_are(sent: bytes) -> None:
    import resource

    mine = resource.getrlimit(resource.RLIMIT_NOFILE)
    many = DESCRIPTORS + 100
    if mine[1] < many + 100:
        pytest.skip("not so many connections allowed")
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(mine[0], many + 100), mine[1]))
    try:
        with ServerProcess(8960) as server, ExitStack() as open_ends:
            resource.prlimit(server.process.pid, resource.RLIMIT_NOFILE, (DESCRIPTORS, mine[1]))
            address = server.address.hostname, server.address.port
            for _ in range(many):
                connection = open_ends.enter_context(socket.create_connection(address, timeout=PATIENCE_S))
                connection.sendall(sent)
            assert server.ask("POST", "devices/stop") == {"devices": []}
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, mine)
