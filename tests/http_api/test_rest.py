"""Motions whose answer waits until the device is at rest."""

from __future__ import annotations

import threading
from typing import Any

import pytest
from starlette.testclient import TestClient

from designs import document
from waiting import until


@pytest.fixture
def path(client: TestClient) -> str:
    device = client.post("/api/v1/devices", json={"port": "sim://"}).json()["id"]
    path = f"/api/v1/devices/{device}"
    # 1000 steps/s: 300 steps take half a second.
    assert client.post(f"{path}/push", json={"design": document()}).status_code == 200
    return path


def begin(client: TestClient, path: str, what: str, **body: Any) -> Any:
    answer = client.post(f"{path}/{what}", json=body)
    assert answer.status_code == 200, answer.text
    return answer.json()


@pytest.mark.parametrize(
    ("what", "body", "position"),
    [
        ("move", {"by_steps": 300}, 300),
        ("line", {"axes": [{"axis": 0, "by_steps": -250}]}, -250),
        ("there_and_back", {"by_steps": 60, "times": 2}, 0),
        ("run", {"speed_steps_per_s": 500, "for_s": 0.2}, None),
    ],
)
def test_the_answer_tells_where_it_has_come_to_rest(
    client: TestClient, path: str, what: str, body: dict[str, Any], position: int | None
) -> None:
    rested = begin(client, path, what, **body, wait_s=60)
    assert (rested["state"], rested["shuttle"]) == ("ready", None)
    if position is None:
        assert rested["position_steps"] > 0
    else:
        assert rested["position_steps"] == position


def test_without_a_wait_or_after_it_the_motion_goes_on(client: TestClient, path: str) -> None:
    assert begin(client, path, "move", by_steps=100_000)["state"] == "moving"
    assert begin(client, path, "move", by_steps=100_000, wait_s=0.05)["state"] == "moving"
    client.post(f"{path}/stop")


def test_a_stop_ends_the_wait(client: TestClient, path: str) -> None:
    told: list[Any] = []
    waiting = threading.Thread(target=lambda: told.append(begin(client, path, "move", by_steps=100_000, wait_s=600)))
    waiting.start()
    until(lambda: client.get(path).json()["state"] == "moving")
    client.post(f"{path}/stop")
    waiting.join(60)
    assert [each["state"] for each in told] == ["ready"]
    assert 0 < told[0]["position_steps"] < 100_000


@pytest.mark.parametrize("wait_s", [-1, 86_401, "long"])
def test_waits_that_can_t_be_are_refused(client: TestClient, path: str, wait_s: object) -> None:
    answer = client.post(f"{path}/move", json={"by_steps": 100, "wait_s": wait_s})
    [error] = answer.json()["errors"]
    assert (answer.status_code, error["field"]) == (422, "wait_s")
    assert error["allowed"] == "a number from 0 to 86,400 s"
    assert client.get(path).json()["position_steps"] == 0
