from collections.abc import Iterator
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from http_api.two_axes import device_of
from stepramp.http_api.app import create_app


@pytest.fixture
def client(tmp_path: Path) -> Iterator[TestClient]:
    with TestClient(
        create_app(data=tmp_path), base_url="http://127.0.0.1:8000", raise_server_exceptions=False
    ) as client:
        yield client


@pytest.fixture
def route(client: TestClient) -> str:
    """Return the route of a device with two axes that have a ramp."""
    return device_of(lambda method, path, body: client.request(method, path, json=body).json())
