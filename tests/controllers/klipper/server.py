"""Moonraker at a port of this machine, in real time: its WebSocket, and its files over HTTP."""

from __future__ import annotations

import asyncio
import socket
import threading
import time
from contextlib import suppress
from typing import Self

import uvicorn
from fastapi import FastAPI, Request, Response, WebSocket, WebSocketDisconnect

from controllers.klipper.moonraker import Moonraker
from controllers.klipper.printer import Printer

TELLS_EVERY_S = 0.05


class MoonrakerServer:
    """It listens while the context lasts. address: its port, as StepRamp names it."""

    def __init__(self, key: str | None = None, files: dict[str, str] | None = None) -> None:
        self.printer = Printer(time.monotonic, files)
        self.moonraker = Moonraker(self.printer, key)
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.host = f"127.0.0.1:{self._listener.getsockname()[1]}"
        self.address = f"moonraker://{self.host}"
        self._lock = threading.Lock()
        """Tests look at the printer while it is served."""
        config = uvicorn.Config(self._app(), log_level="error", lifespan="off", timeout_graceful_shutdown=1)
        self._server = uvicorn.Server(config)
        self._thread = threading.Thread(target=self._server.run, kwargs={"sockets": [self._listener]})

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._server.should_exit = True
        self._thread.join()
        self._listener.close()

    def _app(self) -> FastAPI:
        app = FastAPI()

        @app.websocket("/websocket")
        async def talk(websocket: WebSocket) -> None:
            if not self.moonraker.lets_in(dict(websocket.headers)):
                await websocket.close()
                return
            await websocket.accept()
            telling = asyncio.create_task(self._tell(websocket))
            try:
                while True:
                    text = await websocket.receive_text()
                    with self._lock:
                        said = self.moonraker.message(text)
                    for each in said:
                        await websocket.send_text(each)
            except (WebSocketDisconnect, RuntimeError):
                pass
            finally:
                telling.cancel()

        @app.api_route("/{path:path}", methods=["GET", "POST"])
        async def files(request: Request, path: str) -> Response:
            body = await request.body()
            with self._lock:
                status, said = self.moonraker.http(request.method, f"/{path}", dict(request.headers), body)
            return Response(said, status)

        return app

    async def _tell(self, websocket: WebSocket) -> None:
        with suppress(RuntimeError, WebSocketDisconnect):
            while True:
                await asyncio.sleep(TELLS_EVERY_S)
                with self._lock:
                    said = self.moonraker.notifications()
                for each in said:
                    await websocket.send_text(each)
