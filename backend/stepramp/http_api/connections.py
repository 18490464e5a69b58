"""Connections to the server: so many and no more, so that one over which a stop comes is always accepted.

When there are too many, that one ends whose end harms least: one that never sent anything, then one between two
requests, then one whose request doesn't come to its end; of these the one that has waited longest. One that has just
come, whose request has just begun or been answered, or at which bytes wait to be read outlives all of these: it may be
a stop that wasn't read yet, or whoever has just stopped.
"""

import asyncio
import socket
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from select import select
from typing import Any
from weakref import WeakSet

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

MOST_CONNECTIONS = 512
MOST_NEW = 64
"""So many are accepted in a turn of the loop, and it takes four turns until one that has to go is gone."""
MOST_WAITING = 1024
"""So many wait in the system until they are accepted."""
MOST_LATE = MOST_WAITING + 1 + MOST_NEW
"""So many at most have come when a stop is answered, and are not known yet: those that wait, of which Linux takes one
more than it is told, and those that were accepted in this turn."""
DESCRIPTORS = 1024
"""Files and connections that the process may have open: all connections, those of four turns, and 256 others. More are
no use: pyserial waits by `select`, which knows no descriptors from 1,024 on."""
HEARD_WITHIN_S = 15.0
"""A connection that has sent nothing for so long, and a request that has not come whole, end within twice that [s]."""
STEADY_BYTES = 100_000
"""A request that brings so many in that time goes on: files take minutes. No head of a request has as many [bytes]."""

NEW_S = 1.0
"""So long a connection that has sent nothing, only the begin of a request, or that was answered, is new [s]."""

TURNS_TO_KNOW = 2
"""Of the loop, within which all that it has accepted are known, and none that it accepts later."""


def readable(sockets: Iterable[socket.socket]) -> list[socket.socket]:
    """Return those that something waits at to be read, or accepted."""
    candidates = list(sockets)
    # Windows takes none at all for a mistake.
    return select(candidates, [], [], 0)[0] if candidates else []


class Stage(IntEnum):
    """What a connection is doing. The least ends first."""

    ENDING = 0
    SILENT = 1
    BETWEEN = 2
    BEGUN = 3
    NEW = 4
    SERVED = 5


UNHEARD = (Stage.SILENT, Stage.BEGUN)


@dataclass
class _Answered:
    """A stop that was answered while others may have waited to be accepted.

    request_number: how old these are. most_left: so many can be left of them. turns: see TURNS_TO_KNOW.
    """

    request_number: int
    most_left: int
    are_all_accepted: bool
    turns: int = TURNS_TO_KNOW


class Connections:
    """Those that are open, in one event loop.

    most: how many there may be. heard_within_s: see HEARD_WITHIN_S. new_s: see NEW_S.
    """

    def __init__(
        self, most: int = MOST_CONNECTIONS, heard_within_s: float = HEARD_WITHIN_S, new_s: float = NEW_S
    ) -> None:
        self._most = most
        self.heard_within_s = heard_within_s
        self.new_s = new_s
        self._open: set[Connection] = set()
        # Those that were accepted, and whose handshake, if they are encrypted, isn't done yet.
        self._coming: WeakSet[Connection] = WeakSet()
        self._listener: socket.socket | None = None
        self._answered: list[_Answered] = []

    def listen(self, listener: socket.socket) -> None:
        """Know where those come from that wait until they are accepted."""
        self._listener = listener

    def add(self, connection: "Connection") -> None:
        """Take one more; end another one when there are too many."""
        if len(self._open) >= self._most:
            # Those that became WebSockets don't tell of their end.
            self._open = {each for each in self._open if not each.is_over}
        if len(self._open) >= self._most:
            unread = set(readable(each.end for each in self._open if not each.transport.is_closing()))
            min(self._open, key=lambda each: each.turn_to_end(each.end in unread)).transport.abort()
        self._open.add(connection)
        self._coming.discard(connection)

    def come(self, connection: "Connection") -> int | None:
        """Know one that was accepted; return what it counts as asked for then, if that is before a stop's answer."""
        self._coming.add(connection)
        for each in self._answered:
            each.most_left -= 1
        return min((each.request_number for each in self._answered if each.most_left >= 0), default=None)

    def make_unread_as_old_as(self, request_number: int, but: Sequence[object] | None = None) -> None:
        """Have what has come in, and waits to be read, count as asked for then.

        but: the address of a client of whom this doesn't hold, since it has only now been answered.
        """
        # At once: whoever has the answer may connect anew while we look at all the others.
        is_any_waiting = self._listener is not None and bool(readable([self._listener]))
        listening = {each.end: each for each in self._open if each.is_listening}
        for unread in readable(listening):
            if but is None or tuple(but) != listening[unread].client:
                listening[unread].make_as_old_as(request_number)
        for coming in self._coming:
            coming.come_before(request_number)
        if self._listener is not None:
            self._answered.append(_Answered(request_number, MOST_LATE, are_all_accepted=not is_any_waiting))
            if len(self._answered) == 1:
                asyncio.get_running_loop().call_soon(self._see_who_waits, self._listener)

    def _see_who_waits(self, listener: socket.socket) -> None:
        """Forget a stop's answer once all are known that waited then, however many have come since."""
        is_empty = not readable([listener])
        for each in self._answered:
            each.turns -= each.are_all_accepted
            each.are_all_accepted |= is_empty
        self._answered = [each for each in self._answered if each.turns > 0 and each.most_left > 0]
        if self._answered:
            asyncio.get_running_loop().call_soon(self._see_who_waits, listener)

    async def take_or_cut(self, client: Sequence[object] | None, within_s: float) -> None:
        """Return once a client's connection is free of what was written to it before; see Connection.take_or_cut."""
        for each in [each for each in self._open if each.is_listening and client and each.client == tuple(client)]:
            await each.take_or_cut(within_s)

    def discard(self, connection: "Connection") -> None:
        """Note that one has ended."""
        self._open.discard(connection)


class Connection(H11Protocol):
    """The server's protocol of HTTP, for one connection among others."""

    def __init__(self, connections: Connections, **options: Any) -> None:
        super().__init__(**options)
        self._connections = connections
        self._waits_since_s = self.loop.time()
        self._is_silent = True
        self._heard_bytes = 0
        """Since it was looked at whether it sends."""
        self._is_encrypted = self.config.is_ssl
        late = connections.come(self)
        # Nobody has sent a request, encrypted, before we have said hello.
        self._came_before = None if self._is_encrypted else late

    def come_before(self, request_number: int) -> None:
        """Note, before it is made, that a stop is answered; a request that was sent counts as asked for then."""
        self._came_before = min(request_number, self._came_before or request_number)

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]  # like its base
        """Begin to serve; end another connection when there are too many."""
        super().connection_made(transport)
        self._connections.add(self)
        # What came with the end of a handshake has been read already.
        if self._came_before is not None and (self._is_encrypted or readable([self.end])):
            self.make_as_old_as(self._came_before)
        self._look_later()

    def connection_lost(self, exc: Exception | None) -> None:
        """Note the end."""
        self._look.cancel()
        self._connections.discard(self)
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Take what was sent; with the first byte of a request its time begins."""
        if self.stage < Stage.BEGUN:
            self._waits_since_s = self.loop.time()
        self._is_silent = False
        self._heard_bytes += len(data)
        super().data_received(data)

    def on_response_complete(self) -> None:
        """Wait for the next request, which may have begun already."""
        self._waits_since_s = self.loop.time()
        super().on_response_complete()

    async def take_or_cut(self, within_s: float) -> None:
        """Return once the system has taken all that was written, or it has gone; cut it when that lasts too long."""
        if self.transport.is_closing():
            return
        # Of what is little the server's protocol wouldn't wait. Not 0: over TLS even nothing would be too much.
        self.transport.set_write_buffer_limits(high=1)
        try:
            async with asyncio.timeout(within_s):
                await self.flow.drain()
        except TimeoutError:
            self.transport.abort()
        if not self.transport.is_closing():
            self.transport.set_write_buffer_limits()

    def make_as_old_as(self, request_number: int) -> None:
        """Have what waits to be read count as asked for then."""

    @property
    def end(self) -> socket.socket:
        """Our end of it."""
        ours: socket.socket = self.transport.get_extra_info("socket")
        return ours

    @property
    def is_listening(self) -> bool:
        """Whether requests come over it."""
        return not (self.transport.is_closing() or self._is_websocket)

    @property
    def is_over(self) -> bool:
        """Whether it has ended, or will in the next turn of the loop."""
        if not self.transport.is_closing():
            return False
        try:
            return self.transport.get_write_buffer_size() == 0
        except AttributeError:  # Over TLS, one that was closed twice has let go of all that it had.
            return True

    @property
    def stage(self) -> Stage:
        """What it is doing."""
        if self.transport.is_closing():
            return Stage.ENDING
        if self._is_silent:
            return Stage.SILENT
        if self._is_websocket or self._is_answering:
            return Stage.SERVED
        is_at_rest = self.conn.their_state is h11.IDLE and not self.conn.trailing_data[0]
        return Stage.BETWEEN if is_at_rest else Stage.BEGUN

    def turn_to_end(self, has_unread: bool) -> tuple[Stage, float]:
        """Return what it is doing, and since when: the least ends first.

        has_unread: bytes wait to be read, which have come just now.
        """
        stage, since_s, now_s = self.stage, self._waits_since_s, self.loop.time()
        if has_unread and Stage.ENDING < stage < Stage.SERVED:
            return Stage.NEW, now_s
        is_new = Stage.ENDING < stage < Stage.SERVED and now_s - since_s < self._connections.new_s
        return (Stage.NEW if is_new else stage), since_s

    @property
    def _is_websocket(self) -> bool:
        return self.transport.get_protocol() is not self

    @property
    def _is_answering(self) -> bool:
        """Whether a request that has come whole is being answered."""
        return self.cycle is not None and not self.cycle.response_complete and not self.cycle.more_body

    def _look_later(self) -> None:
        self._look = self.loop.call_later(self._connections.heard_within_s, self._end_when_late)

    def _end_when_late(self) -> None:
        if not self.is_listening:
            return
        is_late = self.loop.time() - self._waits_since_s >= self._connections.heard_within_s
        is_steady = self._heard_bytes >= STEADY_BYTES
        self._heard_bytes = 0
        if is_late and self.stage in UNHEARD and not is_steady:
            self.transport.abort()
        else:
            self._look_later()


def allow_descriptors() -> None:
    """Let the process have so many files and connections open as it may need, where the system says fewer."""
    if sys.platform != "win32":  # It has no such limit.
        import resource  # noqa: PLC0415  # not on Windows

        soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
        if soft < DESCRIPTORS:
            resource.setrlimit(resource.RLIMIT_NOFILE, (min(DESCRIPTORS, hard), hard))
