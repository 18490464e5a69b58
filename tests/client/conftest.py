from __future__ import annotations

from collections.abc import Iterator
from typing import Any
from urllib.parse import urlunsplit

import pytest

from client.awaited import Awaited
from server_process import ServerProcess
from stepramp.client import AsyncClient, Client


@pytest.fixture(scope="session")
def url(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Return the address of a server that these tests share."""
    with ServerProcess(8700, "--data-folder", str(tmp_path_factory.mktemp("data"))) as server:
        yield urlunsplit(server.address)


@pytest.fixture(params=["waits", "is awaited"])
def client(request: pytest.FixtureRequest, url: str) -> Iterator[Any]:
    if request.param == "waits":
        with Client(url) as client:
            yield client
    else:
        awaited = Awaited(AsyncClient(url))
        yield awaited
        awaited.end()
