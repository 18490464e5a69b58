"""The client that is awaited, for tests that wait."""

from __future__ import annotations

import asyncio
from typing import Any

from stepramp.client import AsyncClient


class Awaited:
    """An AsyncClient whose methods wait, so that one test holds for both."""

    def __init__(self, client: AsyncClient) -> None:
        self._client = client
        self._loop = asyncio.new_event_loop()

    def __getattr__(self, name: str) -> Any:
        method = getattr(self._client, name)

        def wait(*arguments: Any, **options: Any) -> Any:
            async def asked() -> Any:
                return await method(*arguments, **options)

            return self._loop.run_until_complete(asked())

        return wait

    def end(self) -> None:
        self._loop.run_until_complete(self._client.close())
        self._loop.close()
