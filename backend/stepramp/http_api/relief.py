"""Relief: other processes plan small profiles while many ask for them at once.

Python runs one thread of a process at a time: in the server's, a stop waits for its turn among all profiles. The other
processes know of no device, and of nothing that lasts. They are begun when they are first needed, since they take
seconds and memory, and end when they aren't any more.
"""

import asyncio
import logging
import os
import sys
from collections import deque
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Future, ProcessPoolExecutor
from multiprocessing.context import SpawnContext, SpawnProcess
from typing import Any

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from stepramp.http_api.bodies import LARGE_BYTES
from stepramp.http_api.lanes import COMPILED
from stepramp.http_api.memory import machine_bytes
from stepramp.http_api.relief_process import PROFILE, Answered, Asked, answers, begin

_logger = logging.getLogger(__name__)

MANY = 8
"""So many who ask for a profile at a time are served by the server's process itself."""
MOST_PROCESSES = 3
"""More would plan more than the server's process can take in and send."""
A_PROCESS_BYTES = 190_000_000
SHARE = 1 / 8
"""Of the machine's memory, for all processes together."""
MOST_TOGETHER = 8
"""So many requests at most go to a process at once, where many wait: to hand over one takes as long as some. Their
answers are sent in one turn of the loop, some 0.1 ms each."""
MOST_AHEAD = 2
"""So many of these a process has at a time: it begins with the second while the first one's answers go back."""
MOST_WAITING = 256
"""So many wait to be handed over; who comes then is passed on, and refused where others are served already."""
ANSWERED_WITHIN_S = 5.0
"""A process that hasn't answered after so long stands still, whatever it is that holds it [s]."""
NEEDED_S = 60.0
"""Processes that nothing has been handed to for so long end [s]."""

Waiting = tuple[Asked, "asyncio.Future[Answered | None]"]


def processes_here() -> int:
    """Return how many processes this machine has cores and memory for, besides the server's."""
    cores = len(os.sched_getaffinity(0)) if sys.platform == "linux" else os.cpu_count() or 1
    known_bytes = machine_bytes()
    room = MOST_PROCESSES if known_bytes is None else int(known_bytes * SHARE / A_PROCESS_BYTES)
    return min(cores - 1, room, MOST_PROCESSES)


class Relief:
    """Middleware: has other processes answer those who ask for small profiles while many others do.

    most_processes: how many there may be; none is begun where that is 0. What they don't answer, since it would take
    long or something went wrong, is answered as ever.
    """

    def __init__(self, app: ASGIApp, most_processes: int | None = None) -> None:
        self._app = app
        self._most_processes = processes_here() if most_processes is None else most_processes
        self._asking = 0
        self._processes: Processes | None = None

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer, or pass on."""
        if scope["type"] == "lifespan":
            try:
                await self._app(scope, receive, send)
            finally:
                self._end()
        elif self._most_processes and _asks_for_little(scope):
            body = await _whole_body(receive)
            if body is not None:
                self._asking += 1
                try:
                    await self._serve(scope, body, receive, send)
                finally:
                    self._asking -= 1
        else:
            await self._app(scope, receive, send)

    async def _serve(self, scope: Scope, body: bytes, receive: Receive, send: Send) -> None:
        processes = self._when_needed()
        answer: Answered | None = None
        if processes is not None and processes.have_room:
            answered = processes.answer(Asked(scope["query_string"], list(scope["headers"]), body))
            leaving = asyncio.ensure_future(receive())
            leaving.add_done_callback(lambda _: answered.cancel())
            try:
                answer = await answered
            except asyncio.CancelledError:
                if leaving.done():  # Who asked has gone.
                    return
                raise
            finally:
                leaving.cancel()
        if answer is None:
            await self._app(scope, _once_more(body, receive), send)
        else:
            await send({"type": "http.response.start", "status": answer.status, "headers": answer.headers})
            await send({"type": "http.response.body", "body": answer.body, "more_body": False})

    def _when_needed(self) -> "Processes | None":
        """Return the processes if many ask; begin them if there are none."""
        # What isn't compiled here yet would be compiled there as well.
        if self._asking <= MANY or not COMPILED.is_set():
            return None
        if self._processes is None:
            self._processes = Processes(self._most_processes, self._end)
        return self._processes

    def _end(self) -> None:
        if self._processes is not None:
            self._processes.end()
            self._processes = None


class Spawning(SpawnContext):
    """Begins processes for a pool, and knows them: the pool itself waits for ever for one that stands still.

    None is forked: a copy of this process would have its devices, its sockets, and locks that nobody opens.
    """

    def __init__(self) -> None:
        self._begun: list[SpawnProcess] = []
        self.has_ended = False

    def Process(self, *arguments: Any, **named: Any) -> SpawnProcess:  # type: ignore[override]  # noqa: N802  # its name
        """Return a process that is to be started."""
        if self.has_ended:
            raise OSError("They have been ended.")
        process = SpawnProcess(*arguments, **named)
        self._begun.append(process)
        return process

    def end(self) -> None:
        """Kill all of them; what they have in hand is of no use any more."""
        self.has_ended = True
        for process in self._begun:
            if process.pid is not None:
                process.kill()


class Processes:
    """Processes that plan, asked in the server's event loop. Whatever becomes of them, all that is asked is answered.

    let_go: called when nothing has been handed to them for NEEDED_S, also when they ended by themselves before.
    """

    def __init__(self, count: int, let_go: Callable[[], None]) -> None:
        self._count, self._let_go = count, let_go
        self._loop = asyncio.get_running_loop()
        self._spawning = Spawning()
        self._pool: ProcessPoolExecutor | None = None
        self._waiting: deque[Waiting] = deque()
        self._beginning = self._loop.create_task(self._begin())
        self._tasks: set[asyncio.Task[None]] = set()
        self._ahead = 0
        self._letting_go: asyncio.TimerHandle | None = None
        self._are_ready = False

    @property
    def have_room(self) -> bool:
        """Whether they are ready for one more."""
        return self._are_ready and len(self._waiting) < MOST_WAITING

    def answer(self, asked: Asked) -> "asyncio.Future[Answered | None]":
        """Return what one of them will answer, None where none does; cancelled, it is not computed if it waits."""
        self._let_go_later()
        answered: asyncio.Future[Answered | None] = self._loop.create_future()
        self._waiting.append((asked, answered))
        self._hand_over()
        return answered

    def end(self) -> None:
        """Let them end; what they haven't answered they never will."""
        self._are_ready = False
        if self._letting_go is not None:
            self._letting_go.cancel()
        self._beginning.cancel()
        self._end_processes()
        self._hand_over()

    async def _begin(self) -> None:
        try:
            for begun in await asyncio.to_thread(self._begun):
                await asyncio.wrap_future(begun)
            self._are_ready = True
        except (OSError, NotImplementedError, BrokenExecutor) as error:
            _logger.warning("No other processes plan profiles for a minute: they end as they begin. %s", error)
        self._let_go_later()

    def _let_go_later(self) -> None:
        if self._letting_go is not None:
            self._letting_go.cancel()
        self._letting_go = self._loop.call_later(NEEDED_S, self._let_go)

    def _begun(self) -> list[Future[list[Answered | None]]]:
        self._pool = ProcessPoolExecutor(self._count, self._spawning, begin)
        try:
            return [self._pool.submit(answers, []) for _ in range(self._count)]
        finally:
            if self._spawning.has_ended:
                self._end_processes()

    def _end_processes(self) -> None:
        self._spawning.end()
        if self._pool is not None:
            self._pool.shutdown(wait=False, cancel_futures=True)

    def _hand_over(self) -> None:
        while self._waiting and (self._ahead < MOST_AHEAD * self._count or not self._are_ready):
            some = [self._waiting.popleft() for _ in range(min(MOST_TOGETHER, len(self._waiting)))]
            some = [each for each in some if not each[1].done()]  # The clients of the others have gone.
            if not self._are_ready:
                _settle(some, [None] * len(some))
            elif some:
                self._ahead += 1
                task = self._loop.create_task(self._ask(some))
                self._tasks.add(task)
                task.add_done_callback(self._tasks.discard)

    async def _ask(self, some: list[Waiting]) -> None:
        made: list[Answered | None] = [None] * len(some)
        try:
            asking = self._loop.run_in_executor(self._pool, answers, [asked for asked, _ in some])
            made = await asyncio.wait_for(asking, ANSWERED_WITHIN_S)
        except Exception as error:
            if self._are_ready:
                why = "They don't answer." if isinstance(error, TimeoutError) else error
                _logger.warning("No other processes plan profiles for a minute. %s", why)
            self._are_ready = False
        finally:
            self._ahead -= 1
            _settle(some, made)
            self._hand_over()


def _settle(some: list[Waiting], made: list[Answered | None]) -> None:
    for (_, answered), answer in zip(some, made, strict=True):
        if not answered.done():  # Its client may have gone.
            answered.set_result(answer)


def _asks_for_little(scope: Scope) -> bool:
    """Tell whether a request is for a profile, by a body that is as small as it says itself, and comes in one piece."""
    if scope["type"] != "http" or scope["path"] != PROFILE or scope["method"] != "POST":
        return False
    headers = Headers(scope=scope)
    told = headers.get("content-length", "")
    is_small = told.isdecimal() and len(told) < 9 and int(told) <= LARGE_BYTES
    return is_small and "transfer-encoding" not in headers


async def _whole_body(receive: Receive) -> bytes | None:
    """Return a request's body; None where its client goes before it has sent all of it."""
    parts: list[bytes] = []
    while True:
        message = await receive()
        if message["type"] == "http.disconnect":
            return None
        parts.append(message.get("body", b""))
        if not message.get("more_body", False):
            return b"".join(parts)


def _once_more(body: bytes, receive: Receive) -> Receive:
    """Return what receives a body that was read already, and then what comes after it."""
    messages: deque[Message] = deque([{"type": "http.request", "body": body, "more_body": False}])

    async def receive_again() -> Message:
        return messages.popleft() if messages else await receive()

    return receive_again
