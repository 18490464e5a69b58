"""Relief: real processes, which answer just as the server does, and without which it goes on."""

import asyncio
import json
import logging
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing

import psutil
import pytest
from starlette.responses import PlainTextResponse
from starlette.types import Message, Receive, Scope, Send

from designs import document
from event_loop import run, with_lifespan
from server_process import PATIENCE_S, ServerProcess
from stepramp.http_api import relief
from stepramp.http_api.relief import MANY, Relief
from stepramp.http_api.relief_process import PROFILE

JSON = {"content-type": "application/json"}
SMALL = {"design": document(), "max_points": 200}
ASKED: list[tuple[str, dict[str, str], object]] = [
    ("", JSON, SMALL),
    ("?max_points=3", JSON, SMALL),
    ("", JSON, SMALL | {"first_step": 10, "last_step": 20}),
    ("", JSON | {"accept": "text/csv"}, SMALL),
    ("", JSON | {"accept": "application/x-npz"}, SMALL),
    ("", JSON | {"accept": "image/png"}, SMALL),
    ("", JSON | {"accept-encoding": "gzip"}, SMALL),
    ("", {"content-type": "text/plain"}, SMALL),
    ("", JSON | {"content-encoding": "gzip"}, SMALL),
    ("", JSON, {"design": document(ramp__slew_speed_steps_per_s=-1)}),
    ("", JSON, {"design": document(), "max_pionts": 200}),
    ("", JSON, "nonsense"),
    # These take long: the server itself plans them.
    ("", JSON, {"design": document(move__steps=50_000), "max_points": 100}),
    ("", JSON, {"design": document(move__steps=2_000)}),
]
OF_EACH = ("date", "content-length", "transfer-encoding")
"""Headers that may differ: before its numerics are compiled, the server sends in parts."""


@pytest.fixture
def server() -> Iterator[ServerProcess]:
    with ServerProcess(8970) as server:
        yield server


def answered(server: ServerProcess, query: str, headers: dict[str, str], body: object) -> tuple[int, object, bytes]:
    """Return what is answered, but for what differs from one answer to the next."""
    with closing(server.connection()) as connection:
        connection.request("POST", PROFILE + query, json.dumps(body), headers)
        response = connection.getresponse()
        told = sorted((name, value) for name, value in response.getheaders() if name.lower() not in OF_EACH)
        return response.status, told, response.read()


def others_of(server: ServerProcess) -> list[psutil.Process]:
    """Return the server's processes of relief."""
    children = psutil.Process(server.process.pid).children()
    return [each for each in children if any("spawn_main" in word for word in each.cmdline())]


def cpu_s(processes: list[psutil.Process]) -> float:
    times = [each.cpu_times() for each in processes]
    return sum(each.user + each.system for each in times)


def test_other_processes_answer_just_as_the_server_and_end_with_it(server: ServerProcess) -> None:
    expected = [answered(server, *each) for each in ASKED]
    statuses = [200, 200, 200, 200, 200, 406, 200, 415, 415, 422, 422, 422, 200, 200]
    assert [status for status, _, _ in expected] == statuses
    together = ASKED * 3
    with ThreadPoolExecutor(len(together)) as pool:

        def ask_together() -> None:
            got = list(pool.map(lambda each: answered(server, *each), together))
            assert got == expected * 3

        until(lambda: ask_together() or others_of(server))
        others = others_of(server)
        until(lambda: ask_together() or is_at_rest(others))
        before_s = cpu_s(others)
        until(lambda: ask_together() or cpu_s(others) - before_s > 0.05)
    server.process.kill()
    server.ended()
    psutil.wait_procs(others, PATIENCE_S)
    assert not any(each.is_running() for each in others)


def is_at_rest(processes: list[psutil.Process]) -> bool:
    before_s = cpu_s(processes)
    time.sleep(0.2)
    return cpu_s(processes) - before_s < 0.02


def until(condition: Callable[[], object]) -> None:
    end_s = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < end_s


class Crowd:
    """Clients that ask at once, of a server that tells of itself when it answers."""

    def __init__(self) -> None:
        self.relief = Relief(self.serve, most_processes=1)
        self.have_left = asyncio.Event()

    async def serve(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await receive()
            await send({"type": "lifespan.startup.complete"})
            await receive()
            await send({"type": "lifespan.shutdown.complete"})
        else:
            assert json.loads((await receive())["body"])["design"]
            await asyncio.sleep(0.05)
            await PlainTextResponse("here")(scope, receive, send)

    async def ask(self, count: int = 2 * MANY) -> list[bytes]:
        return await asyncio.gather(*(self.answer() for _ in range(count)))

    async def answer(self) -> bytes:
        """Return where a request is answered; nothing, where its client leaves before."""
        text, sent = json.dumps(SMALL).encode(), list[Message]()
        headers = [(b"content-type", b"application/json"), (b"content-length", str(len(text)).encode())]
        messages = iter([{"type": "http.request", "body": text, "more_body": False}])

        async def receive() -> Message:
            message = next(messages, None)
            if message is None:
                await self.have_left.wait()
            return message or {"type": "http.disconnect"}

        async def send(message: Message) -> None:
            sent.append(message)

        scope = {"type": "http", "method": "POST", "path": PROFILE, "headers": headers, "query_string": b""}
        await self.relief(scope, receive, send)
        if not sent:
            return b""
        assert [each["type"] for each in sent] == ["http.response.start", "http.response.body"]
        return b"here" if sent[1]["body"] == b"here" else b"there"

    async def is_relieved(self) -> bool:
        return b"there" in await self.ask()

    async def until_relieved(self) -> None:
        while not await self.is_relieved():
            pass


def children() -> list[psutil.Process]:
    """Return the processes of relief of this one."""
    alive = [each for each in psutil.Process().children() if each.status() != psutil.STATUS_ZOMBIE]
    return [each for each in alive if any("spawn_main" in word for word in each.cmdline())]


@pytest.fixture
def crowd(monkeypatch: pytest.MonkeyPatch) -> Crowd:
    compiled = threading.Event()
    compiled.set()
    monkeypatch.setattr(relief, "COMPILED", compiled)
    return Crowd()


def test_what_becomes_of_the_processes_every_request_is_answered(
    crowd: Crowd, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def few_are_served_here() -> None:
        assert await crowd.ask(MANY) == [b"here"] * MANY

    async def who_has_left_is_not_planned_for(other: psutil.Process) -> None:
        other.suspend()
        given_up = asyncio.create_task(crowd.ask(40 * MANY))
        await asyncio.sleep(0.5)
        crowd.have_left.set()
        await asyncio.sleep(0)
        other.resume()
        before_s = cpu_s([other])
        # The first few were handed over before that, and 8 served here; more than may wait are, too.
        answered = Counter(await given_up)
        assert answered[b""] >= relief.MOST_WAITING
        assert answered[b"here"] >= 40 * MANY - relief.MOST_WAITING - relief.MOST_AHEAD * relief.MOST_TOGETHER
        crowd.have_left = asyncio.Event()
        await crowd.until_relieved()
        assert cpu_s([other]) - before_s < 0.3

    async def who_waits_when_they_end_is_served_here() -> None:
        asked = asyncio.create_task(crowd.ask(20 * MANY))
        await asyncio.sleep(0.002)
        crowd.relief._end()
        assert set(await asked) <= {b"here", b"there"}
        await crowd.until_relieved()

    async def one_that_stands_still_is_not_waited_for(other: psutil.Process) -> None:
        monkeypatch.setattr(relief, "ANSWERED_WITHIN_S", 0.5)
        other.suspend()
        assert await crowd.ask(20 * MANY) == [b"here"] * 20 * MANY
        assert not await crowd.is_relieved()
        assert "They don't answer" in caplog.text

    async def they_are_begun_anew_and_end_when_nobody_asks() -> None:
        crowd.relief._end()
        # Those that stand still, too, would else be there for ever, and keep the server from its end.
        while children():
            await asyncio.sleep(0.05)
        monkeypatch.setattr(relief, "NEEDED_S", 1.0)
        await crowd.until_relieved()
        while children():
            await asyncio.sleep(0.05)

    async def work() -> None:
        await few_are_served_here()
        assert not children()
        await crowd.until_relieved()
        await few_are_served_here()
        await who_has_left_is_not_planned_for(*children())
        await who_waits_when_they_end_is_served_here()
        await one_that_stands_still_is_not_waited_for(children()[-1])
        await they_are_begun_anew_and_end_when_nobody_asks()

    caplog.set_level(logging.WARNING)
    run(with_lifespan(crowd.relief, work, PATIENCE_S))


def test_one_that_ends_by_itself_is_done_without_until_others_are_begun(
    crowd: Crowd, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def work() -> None:
        await crowd.until_relieved()
        [other] = children()
        asked = asyncio.create_task(crowd.ask(20 * MANY))
        await asyncio.sleep(0)
        other.kill()
        assert b"here" in await asked
        while await crowd.is_relieved():
            pass
        assert "No other processes plan profiles for a minute" in caplog.text
        await crowd.until_relieved()

    monkeypatch.setattr(relief, "NEEDED_S", 1.0)
    caplog.set_level(logging.WARNING)
    run(with_lifespan(crowd.relief, work, PATIENCE_S))


@pytest.mark.parametrize("after_s", [0.0, 0.01, 0.1, 0.3, 1.0])
def test_none_is_left_that_was_begun_while_they_were_ended(crowd: Crowd, after_s: float) -> None:
    async def work() -> None:
        await crowd.ask()
        await asyncio.sleep(after_s)
        crowd.relief._end()
        await asyncio.sleep(1.0)
        while children():
            await asyncio.sleep(0.05)

    run(with_lifespan(crowd.relief, work, PATIENCE_S))


def test_without_other_processes_the_server_goes_on(
    crowd: Crowd, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    def no_pool(*_: object) -> None:
        raise OSError("no semaphores")

    async def work() -> None:
        for _ in range(3):
            assert await crowd.ask() == [b"here"] * 2 * MANY

    monkeypatch.setattr(relief, "ProcessPoolExecutor", no_pool)
    caplog.set_level(logging.WARNING)
    run(with_lifespan(crowd.relief, work))
    assert caplog.text.count("no semaphores") == 1


@pytest.mark.parametrize(("machine_bytes", "most"), [(512_000_000, 0), (2_000_000_000, 1), (2**36, 3), (None, 3)])
def test_there_are_as_many_as_there_are_cores_and_memory_for(
    machine_bytes: int | None, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(relief, "machine_bytes", lambda: machine_bytes)
    monkeypatch.setattr(relief.os, "sched_getaffinity", lambda _: set(range(8)), raising=False)
    monkeypatch.setattr(relief.os, "cpu_count", lambda: 8)
    assert relief.processes_here() == most


@pytest.mark.parametrize(
    "headers", [[(b"content-length", b"10"), (b"transfer-encoding", b"chunked")], [(b"content-length", b"16385")], []]
)
def test_what_may_be_large_is_passed_on_unread(headers: list[tuple[bytes, bytes]]) -> None:
    """As to how large it is, a client that sends it in chunks may say anything."""
    passed_on: list[Receive] = []

    async def app(_: Scope, receive: Receive, __: Send) -> None:
        passed_on.append(receive)

    async def unread() -> Message:
        raise AssertionError

    async def send(_: Message) -> None:
        raise AssertionError

    scope = {"type": "http", "method": "POST", "path": PROFILE, "headers": headers, "query_string": b""}
    run(Relief(app, most_processes=1)(scope, unread, send))
    assert passed_on == [unread]
