"""Runs end with their lease, and what a page has in motion with the page; what a program has goes on."""

from __future__ import annotations

import json
import time

import pytest
from starlette.testclient import TestClient

from http_api.two_axes import DEVICES, LOCAL, error_of, until_state
from waiting import until


def test_a_run_ends_with_its_lease_and_goes_on_when_asked_again(client: TestClient, route: str) -> None:
    run = {"speed_steps_per_s": 400, "for_s": 0.6}
    began = time.monotonic()
    while time.monotonic() - began < 1.5:
        assert client.post(f"{route}/run", json=run).json()["state"] == "moving"
        time.sleep(0.2)
    assert client.get(route).json()["position_steps"] > 300
    until(lambda: client.get(route).json()["state"] == "ready")
    assert client.get(route).json()["position_steps"] < 2000


def test_a_run_that_has_slowed_down_is_not_renewed(client: TestClient, route: str) -> None:
    run = {"speed_steps_per_s": 400, "for_s": 0.8, "name": "mine"}
    again = run | {"renews": True}
    assert "was given up" in error_of(client.post(f"{route}/run", json=again), 409)["message"]
    assert client.post(f"{route}/run", json=run).json()["state"] == "moving"
    for _ in range(4):
        time.sleep(0.3)
        assert client.post(f"{route}/run", json=again).json()["state"] == "moving"
    assert "was given up" in error_of(client.post(f"{route}/run", json=again | {"name": "other"}), 409)["message"]
    until(lambda: client.get(route).json()["state"] == "ready")
    place = client.get(route).json()["position_steps"]
    assert "was given up" in error_of(client.post(f"{route}/run", json=again), 409)["message"]
    assert client.get(route).json()["state"] == "ready"
    # Nor does it take over what somebody else runs by now, or come after a stop.
    client.post(f"{route}/run", json={"speed_steps_per_s": 400, "for_s": 60})
    assert "was given up" in error_of(client.post(f"{route}/run", json=again), 409)["message"]
    client.post(f"{route}/run", json=run | {"for_s": 60})
    client.post(f"{route}/stop")
    assert client.post(f"{route}/run", json=again).status_code == 409
    until(lambda: client.get(route).json()["state"] == "ready")
    assert client.get(route).json()["position_steps"] > place
    unnamed = error_of(client.post(f"{route}/run", json={"speed_steps_per_s": 400, "renews": True}), 422)
    assert unnamed["field"] == "name"


@pytest.mark.parametrize("for_s", [0, -1, 86_401, "long", None, 1e400])
def test_leases_that_cant_be(client: TestClient, route: str, for_s: object) -> None:
    body = json.dumps({"speed_steps_per_s": 100, "for_s": for_s}).replace("Infinity", "1e400")
    refused = client.post(f"{route}/run", content=body, headers={"content-type": "application/json"})
    error = error_of(refused, 422)
    assert (error["field"], error["allowed"]) == ("for_s", "a number from 0.05 to 86,400 s")


def test_what_a_page_runs_ends_with_it(client: TestClient, route: str) -> None:
    with client.websocket_connect(f"{DEVICES}/events?page=one", headers=LOCAL) as socket:
        socket.receive_json()
        run = {"axes": [{"axis": 1, "speed_steps_per_s": 300}], "for_s": 3600}
        assert client.post(f"{route}/run", json=run, headers={"X-StepRamp-Page": "one"}).json()["state"] == "moving"
    until(lambda: client.get(route).json()["state"] == "ready")


def test_there_and_back_of_a_page_ends_with_it(client: TestClient, route: str) -> None:
    page = {"X-StepRamp-Page": "one"}
    for pause_s, state in ((0, "moving"), (3600, "ready")):  # On its way, and in the pause at its end.
        with client.websocket_connect(f"{DEVICES}/events?page=one", headers=LOCAL) as socket:
            socket.receive_json()
            body = {"by_steps": 60, "times": 10_000, "pause_s": pause_s}
            assert client.post(f"{route}/there_and_back", json=body, headers=page).json()["shuttle"]
            until_state(client, route, state)
        until(lambda: client.get(route).json()["shuttle"] is None)
        until_state(client, route, "ready")
    late = client.post(f"{route}/there_and_back", json={"by_steps": 60}, headers=page)
    assert "its page is gone" in error_of(late, 409)["message"]


def test_there_and_back_of_a_program_outlives_a_page(client: TestClient, route: str) -> None:
    client.post(f"{route}/there_and_back", json={"by_steps": 60, "times": 10_000})
    with client.websocket_connect(f"{DEVICES}/events?page=one", headers=LOCAL) as socket:
        socket.receive_json()
    time.sleep(0.3)
    assert client.get(route).json()["shuttle"]
    client.post(f"{route}/halt")


def test_a_run_of_a_program_outlives_a_page(client: TestClient, route: str) -> None:
    client.post(f"{route}/run", json={"speed_steps_per_s": 300, "for_s": 3600})
    with client.websocket_connect(f"{DEVICES}/events?page=one", headers=LOCAL) as socket:
        socket.receive_json()
    time.sleep(0.3)
    assert client.get(route).json()["state"] == "moving"
    client.post(f"{route}/halt")


def test_a_page_that_acts_ends_no_run_of_a_program(client: TestClient, route: str) -> None:
    client.post(f"{route}/run", json={"speed_steps_per_s": 300, "for_s": 3600})
    with client.websocket_connect(f"{DEVICES}/events?page=one", headers=LOCAL) as socket:
        socket.receive_json()
        for _ in range(2):
            moved = client.post(
                f"{route}/move", json={"axes": [{"axis": 1, "by_steps": 5}]}, headers={"X-StepRamp-Page": "one"}
            )
            assert moved.json()["in_control"] == "one"
        time.sleep(0.3)
        assert client.get(route).json()["axes"][0]["state"] == "moving"
    client.post(f"{route}/halt")
