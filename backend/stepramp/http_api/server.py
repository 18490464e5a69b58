"""The server's process from its start to its end: whatever else is unfinished then, motors are stopped first."""

import logging
import os
import signal
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import sleep
from types import FrameType

import uvicorn
from uvicorn._types import ASGISendEvent
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from uvicorn.server import HANDLED_SIGNALS

from stepramp.http_api.allocator import give_big_blocks_back
from stepramp.http_api.connections import MOST_WAITING

GRACE_S = 1
"""How long requests that are unfinished at the end may still take [s]."""
END_WITHIN_S = 4.0
"""How long the whole end may take [s]; what hangs then is left behind."""


class Sockets(WebSocketsSansIOProtocol):
    """The server's protocol of WebSockets, to which one that was refused is answered, and no mistake to be logged."""

    async def send(self, message: ASGISendEvent) -> None:
        """Send what the application says."""
        await super().send(message)
        if message["type"] == "websocket.http.response.body" and not message.get("more_body", False):
            # The base takes only a socket that was accepted or closed for one whose handshake is over.
            self.handshake_complete = True


class Server(uvicorn.Server):
    """Serves until a signal ends it.

    end_motion: stops every motor, for good, and takes a few seconds at most.
    """

    def __init__(self, config: uvicorn.Config, end_motion: Callable[[], None]) -> None:
        super().__init__(config)
        self._end_motion = end_motion
        self._stopping: list[threading.Thread] = []

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to listen."""
        await super().startup(sockets)
        for listener in sockets or []:
            # As many as may wait for their turn; the loop accepts but a few of them in each of its own.
            listener.listen(MOST_WAITING)

    def serve_until_ended(self, listener: socket.socket) -> None:
        """Serve on a socket that listens already, and return when all is over."""
        give_big_blocks_back()
        try:
            self.run(sockets=[listener])
        finally:
            for thread in self._stopping:
                thread.join()

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        """Take the signals that end a program, all in the same way; one that is ignored, as by nohup, stays so."""
        if threading.current_thread() is not threading.main_thread():
            yield
            return
        # A terminal that is closed, and Ctrl+\; not every system has them.
        more = [getattr(signal, name) for name in ("SIGHUP", "SIGQUIT") if hasattr(signal, name)]
        ending = [*HANDLED_SIGNALS, *more]
        heeded = [each for each in ending if signal.getsignal(each) is not signal.SIG_IGN]
        before = {each: signal.signal(each, self.handle_exit) for each in heeded}
        try:
            yield
        finally:
            for each, handler in before.items():
                signal.signal(each, handler)

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Stop the motors and end; at a second signal stop them once more, and wait for nothing else."""
        del sig, frame
        # In a thread: a handler runs in the midst of what the main thread does, maybe with a lock that stopping needs.
        stopping = threading.Thread(target=self._end_motion, name="last stop")
        stopping.start()
        self._stopping.append(stopping)
        if self.should_exit:
            self.force_exit = True
        else:
            self.should_exit = True
            # Requests that are cut off at the end are no mistakes to be reported.
            logging.getLogger("uvicorn.error").setLevel(logging.CRITICAL)
            threading.Thread(target=self._leave_behind_what_hangs, name="end", daemon=True).start()

    def _leave_behind_what_hangs(self) -> None:
        sleep(END_WITHIN_S)
        for thread in self._stopping:
            thread.join()
        os._exit(0)
