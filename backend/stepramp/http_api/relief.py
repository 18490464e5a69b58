"""Relief: other processes plan small profiles while many ask for them at once.

Python runs one thread of a process at a time: in the server's, a stop waits for its turn among all profiles. The other
processes know of no device, and of nothing that lasts. They are begun when they are first needed, since they take
seconds and memory, and end when they aren't any more.
"""

import asyncio
import logging
import os
from collections import deque
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Future, ProcessPoolExecutor
from contextlib import suppress
from multiprocessing import get_context

from starlette.datastructures import Headers
from starlette.requests import ClientDisconnect, Request
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from stepramp.http_api.bodies import LARGE_BYTES
from stepramp.http_api.lanes import COMPILED
from stepramp.http_api.relief_process import PROFILE, Answered, Asked, answers, begin

_logger = logging.getLogger(__name__)

MANY = 8
"""So many who ask for a profile at a time are served by the server's process itself."""
MOST_PROCESSES = 3
"""More would plan more than the server's process can take in and send."""
MOST_TOGETHER = 8
"""So many requests at most go to a process at once, where many wait: to hand over one takes as long as some."""
MOST_AHEAD = 2
"""So many of these a process has at a time: it begins with the second while the first one's answers go back."""
NEEDED_S = 60.0
"""Processes that nothing has been handed to for so long end [s]."""


class Relief:
    """Middleware: has other processes answer those who ask for small profiles while many others do.

    most_processes: how many there may be; none is begun where that is 0. What they don't answer, since it would take
    long or something went wrong, is answered as ever.
    """

    def __init__(self, app: ASGIApp, most_processes: int = min((os.cpu_count() or 1) - 1, MOST_PROCESSES)) -> None:
        self._app = app
        self._most_processes = most_processes
        self._asking = 0
        self._processes: Processes | None = None

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer, or pass on."""
        if scope["type"] == "lifespan":
            try:
                await self._app(scope, receive, send)
            finally:
                self._end()
        elif _asks_for_little(scope):
            self._asking += 1
            try:
                await self._serve(scope, receive, send)
            finally:
                self._asking -= 1
        else:
            await self._app(scope, receive, send)

    async def _serve(self, scope: Scope, receive: Receive, send: Send) -> None:
        processes = self._when_needed()
        if processes is None or not processes.are_ready:
            await self._app(scope, receive, send)
            return
        with suppress(ClientDisconnect):
            body = await Request(scope, receive).body()
            answer = await processes.answer(Asked(scope["query_string"], list(scope["headers"]), body))
            if answer is None:
                await self._app(scope, _once_more(body, receive), send)
            else:
                await send({"type": "http.response.start", "status": answer.status, "headers": answer.headers})
                await send({"type": "http.response.body", "body": answer.body, "more_body": False})

    def _when_needed(self) -> "Processes | None":
        """Return the processes if many ask; begin them if there are none."""
        # What isn't compiled here yet would be compiled there as well.
        if self._asking <= MANY or self._most_processes == 0 or not COMPILED.is_set():
            return None
        if self._processes is None:
            self._processes = Processes(self._most_processes, self._end)
        return self._processes

    def _end(self) -> None:
        if self._processes is not None:
            self._processes.end()
            self._processes = None


class Processes:
    """Processes that plan, asked in the server's event loop.

    let_go: called when nothing has been handed to them for NEEDED_S, also when they ended by themselves before.
    """

    def __init__(self, count: int, let_go: Callable[[], None]) -> None:
        self._count, self._let_go = count, let_go
        self._loop = asyncio.get_running_loop()
        self._pool: ProcessPoolExecutor | None = None
        self._waiting: deque[tuple[Asked, asyncio.Future[Answered | None]]] = deque()
        self._tasks = {self._loop.create_task(self._begin())}
        self._ahead = 0
        self._letting_go: asyncio.TimerHandle | None = None
        self.are_ready = False

    async def answer(self, asked: Asked) -> Answered | None:
        """Return what one of them answers; None where none does."""
        self._let_go_later()
        answered: asyncio.Future[Answered | None] = self._loop.create_future()
        self._waiting.append((asked, answered))
        self._hand_over()
        return await answered

    def end(self) -> None:
        """Let them end."""
        if self._letting_go is not None:
            self._letting_go.cancel()
        for task in self._tasks:
            task.cancel()
        if self._pool is not None:
            self._pool.shutdown(wait=False, cancel_futures=True)

    async def _begin(self) -> None:
        try:
            for begun in await asyncio.to_thread(self._begun):
                await asyncio.wrap_future(begun)
            self.are_ready = True
        except (OSError, NotImplementedError, BrokenExecutor) as error:
            _logger.warning("No other processes plan profiles: they couldn't be begun. %s", error)
        self._let_go_later()

    def _let_go_later(self) -> None:
        if self._letting_go is not None:
            self._letting_go.cancel()
        self._letting_go = self._loop.call_later(NEEDED_S, self._let_go)

    def _begun(self) -> list[Future[list[Answered | None]]]:
        # Not forked: a copy of this process would have its devices, its sockets, and locks that nobody opens.
        self._pool = ProcessPoolExecutor(self._count, get_context("spawn"), begin)
        return [self._pool.submit(answers, []) for _ in range(self._count)]

    def _hand_over(self) -> None:
        while self._waiting and self._ahead < MOST_AHEAD * self._count:
            some = [self._waiting.popleft() for _ in range(min(MOST_TOGETHER, len(self._waiting)))]
            self._ahead += 1
            task = self._loop.create_task(self._ask(some))
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)

    async def _ask(self, some: list[tuple[Asked, asyncio.Future[Answered | None]]]) -> None:
        made: list[Answered | None] = [None] * len(some)
        try:
            made = await self._loop.run_in_executor(self._pool, answers, [asked for asked, _ in some])
        except (OSError, BrokenExecutor) as error:
            if self.are_ready:
                _logger.warning("No other processes plan profiles any more: they have ended. %s", error)
            self.are_ready = False
        self._ahead -= 1
        for (_, answered), answer in zip(some, made, strict=True):
            if not answered.done():  # Its client may have gone.
                answered.set_result(answer)
        self._hand_over()


def _asks_for_little(scope: Scope) -> bool:
    """Tell whether a request is for a profile, by a body that is small as it says itself."""
    if scope["type"] != "http" or scope["path"] != PROFILE or scope["method"] != "POST":
        return False
    told = Headers(scope=scope).get("content-length", "")
    return told.isdecimal() and len(told) < 9 and int(told) <= LARGE_BYTES


def _once_more(body: bytes, receive: Receive) -> Receive:
    """Return what receives a body that was read already, and then what comes after it."""
    messages: deque[Message] = deque([{"type": "http.request", "body": body, "more_body": False}])

    async def receive_again() -> Message:
        return messages.popleft() if messages else await receive()

    return receive_again
