"""The client that is awaited, for tests that wait."""

from __future__ import annotations

import asyncio
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from stepramp.client import AsyncClient


class Awaited:
    """An AsyncClient whose methods wait, so that one test holds for both.

    In a thread of its own: a browser that other tests drive keeps an event loop in the main one.
    """

    def __init__(self, client: AsyncClient) -> None:
        self._client = client
        self._runner = asyncio.Runner()
        self._thread = ThreadPoolExecutor(1)

    def __getattr__(self, name: str) -> Any:
        method = getattr(self._client, name)

        def wait(*arguments: Any, **options: Any) -> Any:
            async def asked() -> Any:
                return await method(*arguments, **options)

            return self._thread.submit(self._runner.run, asked()).result()

        return wait

    def end(self) -> None:
        self._thread.submit(self._runner.run, self._client.close()).result()
        self._thread.submit(self._runner.close).result()
        self._thread.shutdown()
