"""The server's application within this program, for who runs no server: the same answers, and the same refusals."""

import asyncio
import os
import threading
from pathlib import Path

import httpx2

from stepramp.http_api.app import create_app
from stepramp.link.remote_ports import KEYS_VARIABLE, RemotePorts

HERE = "http://127.0.0.1"
"""How the application is called by whoever asks it; nothing listens there."""


class InProcess(httpx2.BaseTransport):
    """Answers the requests of a client here. Closing it stops what moves, and lets go of all devices.

    port: the one that the command line names, which may be another machine's: whoever names it means it.
    """

    def __init__(self, port: str | None = None, data: Path | None = None) -> None:
        self._app = create_app(remote_ports=ports_of(port), data=data)
        self._asked = httpx2.ASGITransport(self._app)
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="in process", daemon=True)
        self._thread.start()
        self._is_open = True

    def handle_request(self, request: httpx2.Request) -> httpx2.Response:
        """Return the application's answer, all of it."""
        return asyncio.run_coroutine_threadsafe(self._answer(request), self._loop).result()

    async def _answer(self, request: httpx2.Request) -> httpx2.Response:
        response = await self._asked.handle_async_request(request)
        return httpx2.Response(response.status_code, headers=response.headers, content=await response.aread())

    def close(self) -> None:
        """Let go of everything; a second time it does nothing."""
        if not self._is_open:
            return
        self._is_open = False
        state = self._app.state
        state.devices.close()
        state.jobs.close()
        state.library.close()
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()


def ports_of(port: str | None) -> RemotePorts:
    """Return which ports of other machines may be reached: the one that is named."""
    _, is_address, place = (port or "").partition("://")
    keys = os.environ.get(KEYS_VARIABLE, "")
    return RemotePorts.named([place.strip("/")] if is_address and place.strip("/") else [], keys)
