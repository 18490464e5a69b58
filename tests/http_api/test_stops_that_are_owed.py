"""A stop of all tells of which devices it is owed: they may move on until they answer again."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from starlette.testclient import TestClient

from controllers.grbl.emulator import GrblOnACable
from waiting import until


@pytest.fixture
def cable() -> Iterator[GrblOnACable]:
    with GrblOnACable() as cable:
        yield cable


def test_a_stop_of_all_says_which_device_it_could_not_reach(client: TestClient, cable: GrblOnACable) -> None:
    lost = client.post("/api/v1/devices", json={"port": cable.port, "family": "grbl"}).json()["id"]
    client.post("/api/v1/devices", json={"port": "sim://"})
    assert "errors" not in client.post("/api/v1/devices/stop").json()
    cable.unplug()
    until(lambda: client.get(f"/api/v1/devices/{lost}").json()["state"] == "lost")
    answer = client.post("/api/v1/devices/stop")
    [error] = answer.json()["errors"]
    assert (answer.status_code, len(answer.json()["devices"])) == (200, 2)
    assert cable.port in error["message"]
    assert error["message"].endswith("It is stopped as soon as it answers.")
    with client.websocket_connect("ws://127.0.0.1:8000/api/v1/devices/events") as socket:
        socket.send_json({"do": "stop"})
        told: dict[str, Any] = {}
        while "did" not in told:
            told = socket.receive_json()
    assert [each["message"] for each in told["errors"]] == [error["message"]]
    assert told["devices"]
