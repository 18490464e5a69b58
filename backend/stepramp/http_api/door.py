"""The door: stops are answered at once, in the event loop that the server listens in; all else has a loop of its own.

The server's loop parses HTTP, and answers stops and halts. Every other request and WebSocket is handed over to a
second loop, in a thread of its own, message by message. So whatever validates, plans, connects or waits there, a stop
shares neither loop nor threads with it. What the second loop wants sent is sent one message a turn of the first, so
that a stop waits for one of them at most.
"""

import asyncio
import re
import threading
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from stepramp.errors import Overloaded
from stepramp.http_api.errors import error_response

STOPS = re.compile(r"/api/v1/devices/(stop|[^/]+/(stop|halt))")
MOST_SERVED = 384
"""So many requests and WebSockets are served at a time, besides stops: some connections stay free for these."""
MOST_AHEAD = 4
"""So many messages of a client wait for the second loop; then the client is no longer read from."""
TOO_MUCH = Overloaded(f"{MOST_SERVED:,} requests and WebSockets are open already. Close some, and ask again.")
PIECE_BYTES = 2**18
"""Longer parts of an answer are sent in pieces, so that sending one takes not much longer than sending any other."""


class Door:
    """Middleware: calls the application for stops in the server's loop, for all else in a second loop.

    The second loop lives as long as the application's lifespan, which runs in it. A request or WebSocket whose client
    has gone is cancelled there: what has begun in a thread is done, what waits for its turn is not. What was said over
    a WebSocket before that is read to its end first: it may be a stop.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._inside: asyncio.AbstractEventLoop | None = None
        self._turns: _Turns | None = None
        self._served = 0

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve a request, a WebSocket, or the application's beginning and end."""
        if scope["type"] == "lifespan":
            await self._live(scope, receive, send)
        elif self._inside is None or self._turns is None or is_stop(scope):
            await self._app(scope, receive, send)
        elif self._served >= MOST_SERVED:
            await error_response(TOO_MUCH)(scope, receive, send)
        else:
            with self._counted() as leave:

                async def answer(message: Message) -> None:
                    await send(message)
                    if is_last(message):
                        leave()

                await _Crossing(self._inside, self._turns, receive, answer).serve(self._app, scope)

    @contextmanager
    def _counted(self) -> Iterator[Callable[[], None]]:
        """Count one as served until the end, or until what is yielded is called.

        That is when it has been answered: its client may ask again before the second loop is done with it.
        """
        is_counted = True
        self._served += 1

        def leave() -> None:
            nonlocal is_counted
            self._served -= is_counted
            is_counted = False

        try:
            yield leave
        finally:
            leave()

    async def _live(self, scope: Scope, receive: Receive, send: Send) -> None:
        inside = _Inside()
        turns = _Turns(asyncio.get_running_loop())
        self._inside, self._turns = inside.loop, turns
        try:
            await _Crossing(inside.loop, turns, receive, send).serve(self._app, scope)
        finally:
            self._inside = self._turns = None
            await asyncio.to_thread(inside.end)


def is_stop(scope: Scope) -> bool:
    """Return whether a request stops."""
    return scope["type"] == "http" and scope["method"] == "POST" and STOPS.fullmatch(scope["path"]) is not None


class _Inside:
    """The second loop, in its thread."""

    def __init__(self) -> None:
        began = threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._live(began)), name="inside", daemon=True)
        self._thread.start()
        began.wait()

    async def _live(self, began: threading.Event) -> None:
        self.loop, self._ended = asyncio.get_running_loop(), asyncio.Event()
        began.set()
        await self._ended.wait()

    def end(self) -> None:
        """Cancel what still runs in the loop, and wait until its thread has ended."""
        self.loop.call_soon_threadsafe(self._ended.set)
        self._thread.join()


class _Turns:
    """What the second loop wants done in the server's: one thing a turn, between which what has come in is served."""

    def __init__(self, outside: asyncio.AbstractEventLoop) -> None:
        self._outside = outside
        self._wishes: deque[Callable[[], object]] = deque()
        self._is_awake = False

    def add(self, wish: Callable[[], object]) -> None:
        """Have something done that takes little time; called in the second loop."""
        self._wishes.append(wish)
        if not self._is_awake:
            self._is_awake = True
            self._outside.call_soon_threadsafe(self._take)

    def _take(self) -> None:
        if not self._wishes:
            self._is_awake = False
            # One may have been added in between, by a thread that still saw us awake.
            if not self._wishes:
                return
            self._is_awake = True
        self._outside.call_soon(self._take)
        self._wishes.popleft()()


class _Crossing:
    """A request or a WebSocket on its way from the server's loop, outside, to the second one, inside, and back."""

    def __init__(self, inside: asyncio.AbstractEventLoop, turns: _Turns, receive: Receive, send: Send) -> None:
        self._inside, self._turns = inside, turns
        self._receive_outside, self._send_outside = receive, send
        self._outside = asyncio.get_running_loop()
        self._room = asyncio.Semaphore(MOST_AHEAD)
        self._received: asyncio.Queue[Message] = asyncio.Queue()
        self._start: list[Message] = []
        self._is_answered = self._is_client_gone = self._is_over = False
        self._sending: set[asyncio.Task[None]] = set()
        self._task: asyncio.Task[None] | None = None

    # Outside:

    async def serve(self, app: ASGIApp, scope: Scope) -> None:
        """Call the application inside, and wait until it is done; raise what it raises."""
        called = asyncio.run_coroutine_threadsafe(self._call(app, scope), self._inside)
        listening = asyncio.create_task(self._listen())
        try:
            await asyncio.wrap_future(called)
        except asyncio.CancelledError:
            if not self._is_client_gone:
                raise
        finally:
            for task in (listening, *self._sending):
                task.cancel()

    async def _listen(self) -> None:
        """Hand over what comes in, always ready for the next, so that a client's going is noticed at once."""
        while True:
            await self._room.acquire()
            message = await self._receive_outside()
            if message["type"] in ("http.disconnect", "websocket.disconnect"):
                if not self._is_answered:
                    self._is_client_gone = True
                    self._tell_inside(self._end, message)
                return
            self._tell_inside(self._received.put_nowait, message)

    def _begin_to_send(self, messages: list[Message], sent: asyncio.Future[None]) -> None:
        # In a task: a client that doesn't read holds up nobody else.
        task = asyncio.create_task(self._deliver(messages, sent))
        self._sending.add(task)
        task.add_done_callback(self._sending.discard)

    async def _deliver(self, messages: list[Message], sent: asyncio.Future[None]) -> None:
        error: Exception | None = RuntimeError("The client has gone.")  # Unless it is said otherwise: when cancelled.
        try:
            for message in messages:
                self._is_answered = is_last(message)
                await self._send_outside(message)
            error = None
        except Exception as raised:
            error = raised
        finally:
            self._tell_inside(_settle, sent, error)

    def _tell_inside(self, callback: Callable[..., object], *arguments: object) -> None:
        with suppress(RuntimeError):  # The second loop has ended, and with it whoever is told.
            self._inside.call_soon_threadsafe(callback, *arguments)

    # Inside:

    async def _call(self, app: ASGIApp, scope: Scope) -> None:
        self._task = asyncio.current_task()
        if not self._is_over:
            await app(scope, self._receive, self._send)

    def _end(self, gone: Message) -> None:
        """Cancel what is done for a client that has gone, unless it has said something that was not read yet."""
        if gone["type"] == "websocket.disconnect" and not self._received.empty():
            self._received.put_nowait(gone)
            return
        self._is_over = True
        if self._task is not None:
            self._task.cancel()

    async def _receive(self) -> Message:
        message = await self._received.get()
        # After the last part of a body only the client's going can come, for which there is room.
        if message.get("more_body", True):
            self._turns.add(self._room.release)
        return message

    async def _send(self, message: Message) -> None:
        if message["type"] == "http.response.start":
            # It goes with the first part of the body: one way instead of two.
            self._start = [message]
            return
        for piece in _pieces(message):
            sent = self._inside.create_future()
            messages, self._start = [*self._start, piece], []
            self._turns.add(partial(self._begin_to_send, messages, sent))
            await sent


def is_last(message: Message) -> bool:
    """Return whether nothing is sent after a message."""
    is_body = message["type"] == "http.response.body"
    return message["type"] == "websocket.close" or (is_body and not message.get("more_body", False))


def _settle(sent: asyncio.Future[None], error: Exception | None) -> None:
    """Let a sender go on, unless it was cancelled."""
    if sent.done():
        return
    if error is None:
        sent.set_result(None)
    else:
        sent.set_exception(error)


def _pieces(message: Message) -> Iterator[Message]:
    """Yield a message as it is, or a long part of a body in pieces."""
    body = message.get("body", b"")
    if message["type"] != "http.response.body" or len(body) <= PIECE_BYTES:
        yield message
        return
    for begin in range(0, len(body), PIECE_BYTES):
        is_last = begin + PIECE_BYTES >= len(body)
        more_body = message.get("more_body", False) or not is_last
        yield {**message, "body": body[begin : begin + PIECE_BYTES], "more_body": more_body}
