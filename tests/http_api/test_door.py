"""The door: what is served in which loop, and that nothing of it keeps a stop waiting."""

import asyncio
import threading
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from typing import Any

import pytest
from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.testclient import TestClient, WebSocketDenialResponse
from starlette.types import Message, Receive, Scope, Send
from starlette.websockets import WebSocket

from event_loop import run, with_lifespan
from stepramp.http_api import door
from stepramp.http_api.door import PIECE_BYTES, Door

PATIENCE_S = 10.0


class Inside:
    """An application behind a door, that tells what happens in it."""

    def __init__(self) -> None:
        self.loops: dict[str, asyncio.AbstractEventLoop] = {}
        self.released = threading.Event()
        self.began = threading.Event()
        self.cancelled = threading.Event()
        self.finished = threading.Event()
        routes = [
            Route("/api/v1/devices/{id}/stop", self.stop, methods=["GET", "POST"]),
            Route("/api/v1/devices/{id}/halt", self.stop, methods=["POST"]),
            Route("/api/v1/devices/stop", self.stop, methods=["POST"]),
            Route("/echo", self.echo, methods=["POST"]),
            Route("/block", self.block),
            Route("/wait", self.wait),
            Route("/fail", self.fail),
            Route("/large", self.large),
            WebSocketRoute("/socket", self.socket),
        ]
        self.app = Starlette(routes=routes, lifespan=self.live, middleware=[Middleware(Door)])
        self.app.add_exception_handler(Exception, self.mistake)

    @asynccontextmanager
    async def live(self, _: Starlette) -> AsyncIterator[None]:
        self.loops["lifespan"] = asyncio.get_running_loop()
        yield
        assert self.loops["lifespan"] is asyncio.get_running_loop()
        self.finished.set()

    async def stop(self, request: Request) -> Response:
        self.loops[f"{request.method} {request.url.path}"] = asyncio.get_running_loop()
        return PlainTextResponse("stopped")

    async def echo(self, request: Request) -> Response:
        self.loops["echo"] = asyncio.get_running_loop()
        return Response(await request.body())

    async def block(self, _: Request) -> Response:
        self.began.set()
        self.released.wait(PATIENCE_S)
        return PlainTextResponse("released")

    async def wait(self, _: Request) -> Response:
        self.began.set()
        try:
            await asyncio.Event().wait()
        finally:
            self.cancelled.set()
        return PlainTextResponse("never")

    async def fail(self, _: Request) -> Response:
        raise ZeroDivisionError

    async def large(self, _: Request) -> Response:
        return Response(bytes(range(256)) * (3 * PIECE_BYTES // 256) + b"end")

    async def socket(self, socket: WebSocket) -> None:
        await socket.accept()
        self.loops["socket"] = asyncio.get_running_loop()
        try:
            while True:
                await socket.send_text(f"heard {await socket.receive_text()}")
        finally:
            self.cancelled.set()

    async def mistake(self, _: Request, error: Exception) -> Response:
        return PlainTextResponse(type(error).__name__, 500)


@pytest.fixture
def inside() -> Inside:
    return Inside()


@pytest.fixture
def client(inside: Inside) -> Iterator[TestClient]:
    with TestClient(inside.app, raise_server_exceptions=False) as client:
        yield client
    assert inside.finished.is_set()


def test_only_stops_are_served_outside(inside: Inside, client: TestClient) -> None:
    for path in ("/api/v1/devices/stop", "/api/v1/devices/7/stop", "/api/v1/devices/7/halt"):
        assert client.post(path).text == "stopped"
    assert client.get("/api/v1/devices/7/stop").text == "stopped"
    assert client.post("/echo", content=b"abc").content == b"abc"
    with client.websocket_connect("/socket") as socket:
        socket.send_text("a")
        assert socket.receive_text() == "heard a"
    second = inside.loops["lifespan"]
    served_inside = {name for name, loop in inside.loops.items() if loop is second}
    assert served_inside == {"lifespan", "echo", "socket", "GET /api/v1/devices/7/stop"}
    served_outside = inside.loops.keys() - served_inside
    assert served_outside == {f"POST /api/v1/devices/{rest}" for rest in ("stop", "7/stop", "7/halt")}


def test_a_stop_is_answered_while_the_second_loop_is_blocked(inside: Inside, client: TestClient) -> None:
    answers: list[str] = []
    thread = threading.Thread(target=lambda: answers.append(client.get("/block").text))
    thread.start()
    assert inside.began.wait(PATIENCE_S)
    assert client.post("/api/v1/devices/stop").text == "stopped"
    assert answers == []
    inside.released.set()
    thread.join()
    assert answers == ["released"]


def test_so_much_is_served_at_a_time_and_stops_besides(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(door, "MOST_SERVED", 2)
    with client.websocket_connect("/socket"), client.websocket_connect("/socket"):
        refused = client.post("/echo", content=b"abc")
        assert refused.status_code == 503
        assert "Close some" in refused.json()["errors"][0]["message"]
        with pytest.raises(WebSocketDenialResponse), client.websocket_connect("/socket"):
            pass
        assert client.post("/api/v1/devices/stop").text == "stopped"
    until_served = (client.post("/echo", content=b"abc") for _ in range(1000))
    assert any(answer.content == b"abc" for answer in until_served)


def test_what_is_raised_inside_is_answered_outside(client: TestClient) -> None:
    response = client.get("/fail")
    assert (response.status_code, response.text) == (500, "ZeroDivisionError")


def test_large_bodies_cross_whole_both_ways(client: TestClient) -> None:
    body = bytes(range(256)) * 40_000
    assert client.post("/echo", content=body).content == body
    large = client.get("/large")
    assert large.content == bytes(range(256)) * (3 * PIECE_BYTES // 256) + b"end"
    assert large.headers["content-length"] == str(3 * PIECE_BYTES + 3)


def http_scope(path: str) -> Scope:
    asked: dict[str, Any] = {"type": "http", "method": "GET", "path": path, "raw_path": path.encode(), "headers": []}
    return asked | {"query_string": b"", "http_version": "1.1", "scheme": "http", "root_path": "", "server": None}


def request_that_goes_away(gone: asyncio.Event) -> Receive:
    messages: list[Message] = [{"type": "http.request", "body": b"", "more_body": False}]

    async def receive() -> Message:
        if messages:
            return messages.pop()
        await gone.wait()
        return {"type": "http.disconnect"}

    return receive


async def refuse_to_send(_: Message) -> None:
    raise AssertionError("nobody is there any more")


def test_a_request_is_cancelled_when_its_client_goes(inside: Inside) -> None:
    async def work() -> None:
        gone = asyncio.Event()
        request = asyncio.create_task(inside.app(http_scope("/wait"), request_that_goes_away(gone), refuse_to_send))
        assert await asyncio.to_thread(inside.began.wait, PATIENCE_S)
        assert not inside.cancelled.is_set()
        gone.set()
        await request
        assert inside.cancelled.is_set()

    run(with_lifespan(inside.app, work))


def test_a_request_is_cancelled_when_the_server_gives_it_up(inside: Inside) -> None:
    async def work() -> None:
        waits = request_that_goes_away(asyncio.Event())
        request = asyncio.create_task(inside.app(http_scope("/wait"), waits, refuse_to_send))
        assert await asyncio.to_thread(inside.began.wait, PATIENCE_S)
        request.cancel()
        with pytest.raises(asyncio.CancelledError):
            await request
        assert await asyncio.to_thread(inside.cancelled.wait, PATIENCE_S)

    run(with_lifespan(inside.app, work))


def test_a_client_that_does_not_read_holds_up_nobody(inside: Inside) -> None:
    async def work() -> None:
        reads, stuck, answered = asyncio.Event(), asyncio.Event(), list[Message]()

        async def slow(_: Message) -> None:
            stuck.set()
            await reads.wait()

        async def quick(message: Message) -> None:
            answered.append(message)

        waits = asyncio.Event()
        first = asyncio.create_task(inside.app(http_scope("/large"), request_that_goes_away(waits), slow))
        await stuck.wait()
        await inside.app(http_scope("/large"), request_that_goes_away(waits), quick)
        assert not first.done()
        assert len(b"".join(message.get("body", b"") for message in answered)) == 3 * PIECE_BYTES + 3
        assert max(len(message.get("body", b"")) for message in answered) == PIECE_BYTES
        reads.set()
        await first

    run(with_lifespan(inside.app, work))


def test_who_has_been_answered_counts_no_more_though_the_second_loop_is_not_done_yet(
    inside: Inside, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else 200 clients that ask again at once would be 400 at times."""
    monkeypatch.setattr(door, "MOST_SERVED", 1)
    ends = threading.Event()

    async def app(scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await inside.app(scope, receive, send)
            return
        await send({"type": "http.response.start", "status": 200, "headers": []})
        await send({"type": "http.response.body", "body": b"", "more_body": False})
        await asyncio.to_thread(ends.wait, PATIENCE_S)

    async def work() -> None:
        statuses, answered = list[int](), asyncio.Event()

        async def send(message: Message) -> None:
            statuses.extend([message["status"]] if "status" in message else [])
            if len(statuses) == 2:
                answered.set()

        waits = request_that_goes_away
        requests = [asyncio.create_task(outer(http_scope("/"), waits(asyncio.Event()), send))]
        while not statuses:
            await asyncio.sleep(0.001)
        requests.append(asyncio.create_task(outer(http_scope("/"), waits(asyncio.Event()), send)))
        await asyncio.wait_for(answered.wait(), PATIENCE_S)
        assert not any(request.done() for request in requests)
        ends.set()
        await asyncio.gather(*requests)
        assert statuses == [200, 200]

    outer = Door(app)
    run(with_lifespan(outer, work))


def test_one_message_a_turn_of_the_servers_loop(inside: Inside) -> None:
    """What many senders want sent at once is not sent all before the loop looks at what has come in."""

    async def work() -> None:
        turns, sent_at = 0, list[int]()

        def turn() -> None:
            nonlocal turns
            turns += 1
            loop.call_soon(turn)

        async def send(message: Message) -> None:
            if message["type"] == "http.response.body":
                sent_at.append(turns)

        loop = asyncio.get_running_loop()
        inside.loops["lifespan"].call_soon_threadsafe(inside.released.wait, PATIENCE_S)
        waits = request_that_goes_away
        requests = [
            asyncio.create_task(inside.app(http_scope("/api/v1/devices/1/stop"), waits(asyncio.Event()), send))
            for _ in range(20)
        ]
        loop.call_soon(turn)
        await asyncio.sleep(0)
        inside.released.set()
        await asyncio.gather(*requests)
        assert len(set(sent_at)) == 20

    run(with_lifespan(inside.app, work))


def test_what_middleware_outside_notes_is_there_inside(inside: Inside) -> None:
    """Its marks on the scope and on messages cross unchanged."""
    noted: dict[str, Any] = {}

    async def inner(scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await inside.app(scope, receive, send)
            return
        noted["scope"], noted["message"] = scope["mark"], (await receive())["mark"]
        await send({"type": "websocket.close", "code": 1000})

    async def work() -> None:
        mark = object()
        messages = [{"type": "websocket.receive", "text": "", "mark": mark}]

        async def receive() -> Message:
            return messages.pop() if messages else await asyncio.Event().wait()  # type: ignore[return-value]

        async def send(message: Message) -> None:
            noted["sent"] = message

        await outer({"type": "websocket", "mark": mark}, receive, send)
        assert noted == {"scope": mark, "message": mark, "sent": {"type": "websocket.close", "code": 1000}}

    outer = Door(inner)
    run(with_lifespan(outer, work))
