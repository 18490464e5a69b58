"""Answers that are planned in their turn, and sent while they are still being written."""

import asyncio
import re
import threading
import zlib
from collections.abc import Callable, Iterable, Iterator
from itertools import chain, islice
from typing import Generic, TypeVar

from starlette.datastructures import Headers
from starlette.responses import Response
from starlette.types import Receive, Scope, Send

from stepramp.http_api.formats import FORMATS, JSON, QUICKLY, Format
from stepramp.http_api.lanes import AT_ONCE, Turns

A = TypeVar("A")

MOST_AHEAD = 32
"""So many pieces are written before the first of them is taken; then the writing waits."""
STALLED_S = 10.0
"""A client that takes nothing for so long is given up: it would keep others from their turn."""


class Wanted:
    """Whether somebody still waits for an answer: asked by a job that can end before it is done."""

    def __init__(self) -> None:
        self._is_so = True

    def is_so(self) -> bool:
        """Tell whether somebody does."""
        return self._is_so

    def end(self) -> None:
        """Note that nobody does any more."""
        self._is_so = False


async def while_wanted(lane: Turns, job: Callable[[], A], wanted: Wanted, receive: Receive) -> A | None:
    """Return what a job makes in its turn; None when its client has left meanwhile, and wanted says so to the job."""
    leaving = asyncio.ensure_future(_ended(wanted, receive))
    try:
        return await lane.run(job)
    except Exception:
        # What a job raises that nobody waits for is told to nobody.
        if wanted.is_so():
            raise
        return None
    finally:
        leaving.cancel()


class Planned(Response, Generic[A]):
    """An answer that a job makes in a lane.

    The job's turn lasts until all but the last pieces are sent, so that no more of large answers is in memory than
    there are turns. What the job raises before is answered as by other routes.
    """

    def __init__(
        self, lane: Turns, job: Callable[[], A], form: Format | None = None, wanted: Wanted | None = None
    ) -> None:
        """Make an answer by a job.

        form: how it is written; None: as JSON, whatever is asked for.
        wanted: what the job asks whether it is to go on, once the client may have left.
        """
        self._form = form or FORMATS[JSON]
        self.media_type = self._form.media_type
        self.status_code = 200
        self.background = None
        self.init_headers()
        self.headers["vary"] = "accept-encoding" if form is None else "accept, accept-encoding"
        self._lane, self._job, self._wanted = lane, job, wanted

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send the answer in pieces as they come."""
        may_zip = not self._form.is_packed and takes_gzip(Headers(scope=scope).get("accept-encoding", ""))
        if self._lane is AT_ONCE:
            await self._send_at_once(may_zip, send)
            return
        written = _Pieces(lambda: self._form.pieces(self._job()), may_zip)
        making = asyncio.ensure_future(self._lane.run(written.make))
        making.add_done_callback(written.end)
        leaving = None if self._wanted is None else asyncio.ensure_future(_ended(self._wanted, receive))
        try:
            await self._send(written, making, send)
        except Exception:
            # What a job raises that nobody waits for is told to nobody.
            if self._wanted is None or self._wanted.is_so():
                raise
        finally:
            if leaving is not None:
                leaving.cancel()
            written.give_up()
            making.cancel()

    async def _send_at_once(self, may_zip: bool, send: Send) -> None:
        pieces = list(self._form.pieces(self._job()))
        if may_zip and len(pieces) > 1:
            self.headers["content-encoding"] = "gzip"
            pieces = list(_zipped(pieces))
        body = b"".join(pieces)
        self.headers["content-length"] = str(len(body))
        await send({"type": "http.response.start", "status": self.status_code, "headers": self.raw_headers})
        await send({"type": "http.response.body", "body": body, "more_body": False})

    async def _send(self, written: "_Pieces", making: asyncio.Future[None], send: Send) -> None:
        piece = await written.take()
        following = await written.take() if piece else b""
        if written.is_zipped:
            self.headers["content-encoding"] = "gzip"
        if not following:
            await making
            self.headers["content-length"] = str(len(piece))
        await send({"type": "http.response.start", "status": self.status_code, "headers": self.raw_headers})
        while following:
            async with asyncio.timeout(STALLED_S):
                await send({"type": "http.response.body", "body": piece, "more_body": True})
            piece, following = following, await written.take()
        await making
        await send({"type": "http.response.body", "body": piece, "more_body": False})


async def _ended(wanted: Wanted, receive: Receive) -> None:
    """Note when the client has left."""
    while (await receive())["type"] != "http.disconnect":
        pass
    wanted.end()


def takes_gzip(accept_encoding: str) -> bool:
    """Tell whether an Accept-Encoding names gzip, and doesn't say that it is not taken."""
    named = {
        name.strip().lower(): quality
        for name, _, quality in (each.partition(";") for each in accept_encoding.split(","))
    }
    quality = named.get("gzip", named.get("x-gzip", "q=0")).replace(" ", "")
    return re.fullmatch(r"q=0(\.0*)?", quality) is None


def _zipped(pieces: Iterable[bytes]) -> Iterator[bytes]:
    """Yield pieces compressed."""
    # 16 more asks for gzip's own header and end.
    packer = zlib.compressobj(QUICKLY, zlib.DEFLATED, zlib.MAX_WBITS + 16)
    for piece in pieces:
        if packed := packer.compress(piece):
            yield packed
    yield packer.flush()


class _Pieces:
    """Pieces of an answer on their way from the thread that writes them to the loop that sends them.

    A long one is compressed there, where that is taken: what fits into a piece isn't worth the time.
    """

    def __init__(self, job: Callable[[], Iterator[bytes]], may_zip: bool) -> None:
        self._job = job
        self._may_zip = may_zip
        self.is_zipped = False
        """Known once the first piece has been taken."""
        self._loop = asyncio.get_running_loop()
        self._pieces: asyncio.Queue[bytes] = asyncio.Queue()
        self._room = threading.Semaphore(MOST_AHEAD)
        self._is_awaited = True

    def make(self) -> None:
        """Do the job and write what it returns, as fast as it is taken."""
        pieces = self._job()
        begin = list(islice(pieces, 2))
        self.is_zipped = self._may_zip and len(begin) > 1
        pieces = chain(begin, pieces)
        for piece in _zipped(pieces) if self.is_zipped else pieces:
            self._room.acquire()
            if not self._is_awaited:
                return
            self._loop.call_soon_threadsafe(self._pieces.put_nowait, piece)

    def end(self, _: asyncio.Future[None]) -> None:
        """Note that no more pieces come."""
        self._pieces.put_nowait(b"")

    async def take(self) -> bytes:
        """Return the next piece; an empty one after the last."""
        piece = await self._pieces.get()
        self._room.release()
        return piece

    def give_up(self) -> None:
        """Let the writing end: nobody takes the pieces any more."""
        self._is_awaited = False
        self._room.release()
