"""Soft limits over HTTP: no motion ends beyond them, and each refusal names them."""

from __future__ import annotations

import time
from typing import Any

import pytest
from starlette.testclient import TestClient

from http_api.two_axes import error_of
from waiting import until


@pytest.mark.parametrize(
    "body",
    [{"by_steps": 2_147_483_647}, {"to_steps": -2_147_483_648}, {"by_steps": 10_000_001}],
)
def test_without_soft_limits_a_way_is_bounded(client: TestClient, route: str, body: dict[str, int]) -> None:
    error = error_of(client.post(f"{route}/move", json=body), 422)
    assert (error["field"], error["value"]) == next(iter(body.items()))
    assert error["allowed"] == (
        "a whole number from -10,000,000 to 10,000,000 steps, since axis 0 has no soft limit there"
    )


def limits(client: TestClient, route: str, **of_axis_0: int | None) -> Any:
    return client.put(f"{route}/soft_limits", json={"axes": [{"axis": 0, **of_axis_0}]})


def test_soft_limits(client: TestClient, route: str) -> None:
    device = limits(client, route, lowest_steps=-100, highest_steps=2000).json()
    assert [(axis["lowest_steps"], axis["highest_steps"]) for axis in device["axes"]] == [(-100, 2000), (None, None)]
    for what, body, field in [
        ("move", {"by_steps": 2001}, "by_steps"),
        ("move", {"to_steps": -101}, "to_steps"),
        ("move", {"axes": [{"axis": 1, "by_steps": 5}, {"axis": 0, "by_steps": -200}]}, "axes.1.by_steps"),
        ("line", {"axes": [{"axis": 0, "by_steps": 3000}, {"axis": 1, "by_steps": 5}]}, "axes.0.by_steps"),
        ("there_and_back", {"by_steps": -500}, "by_steps"),
    ]:
        error = error_of(client.post(f"{route}/{what}", json=body), 422)
        assert error["field"] == field
        assert "within the soft limits of axis 0, -100 to 2,000 steps" in error["allowed"]
    assert client.post(f"{route}/move", json={"to_steps": 2000}).status_code == 200
    # In flight it counts from where it would come to rest.
    assert error_of(client.post(f"{route}/move", json={"by_steps": 1}), 422)["field"] == "by_steps"
    until(lambda: client.get(route).json()["state"] == "ready")
    assert error_of(client.post(f"{route}/run", json={"speed_steps_per_s": 100}), 422)["field"] == "speed_steps_per_s"
    assert client.post(f"{route}/run", json={"speed_steps_per_s": -100}).status_code == 200
    client.post(f"{route}/halt")
    freed = limits(client, route, lowest_steps=None, highest_steps=None).json()
    assert (freed["axes"][0]["lowest_steps"], freed["axes"][0]["highest_steps"]) == (None, None)
    assert client.post(f"{route}/move", json={"by_steps": 3000}).status_code == 200
    client.post(f"{route}/halt")


def test_an_axis_beyond_its_soft_limits_says_so_until_it_is_back(client: TestClient, route: str) -> None:
    """Limits may be set wherever an axis is; what leads back to within them, and that only, moves it."""
    client.post(f"{route}/position", json={"position_steps": 500})
    assert not client.get(route).json()["axes"][0]["is_beyond_limits"]
    axis, other = limits(client, route, lowest_steps=0, highest_steps=400).json()["axes"]
    assert (axis["is_beyond_limits"], other["is_beyond_limits"]) == (True, False)
    assert error_of(client.post(f"{route}/move", json={"by_steps": -50}), 422)["field"] == "by_steps"
    assert error_of(client.post(f"{route}/run", json={"speed_steps_per_s": 50}), 422)["field"] == "speed_steps_per_s"
    assert client.post(f"{route}/move", json={"by_steps": -100}).status_code == 200
    until(lambda: client.get(route).json()["state"] == "ready")
    assert not client.get(route).json()["axes"][0]["is_beyond_limits"]


def test_a_run_comes_to_rest_within_soft_limits(client: TestClient, route: str) -> None:
    limits(client, route, highest_steps=1500)
    client.post(f"{route}/run", json={"speed_steps_per_s": 900, "for_s": 600})
    until(lambda: client.get(route).json()["state"] == "ready")
    # 900 steps/s with 5,000 steps/s² take 81 steps to stop, and the server needs a moment to see them coming.
    assert 1000 < client.get(route).json()["position_steps"] <= 1500


@pytest.mark.parametrize(
    ("body", "field"),
    [
        ({}, "axes"),
        ({"axes": []}, "axes"),
        ({"axes": [{"axis": 4}]}, "axes.0.axis"),
        ({"axes": [{"axis": 0}, {"axis": 2, "highest_steps": 5}]}, "axes.1.axis"),
        ({"axes": [{"axis": 0}, {"axis": 0, "highest_steps": 5}]}, "axes.1.axis"),
        ({"axes": [{"axis": 0, "lowest_steps": 5, "highest_steps": 4}]}, "axes.0.highest_steps"),
        ({"axes": [{"axis": 0, "lowest_steps": "none"}]}, "axes.0.lowest_steps"),
    ],
)
def test_soft_limits_that_cant_be(client: TestClient, route: str, body: Any, field: str) -> None:
    assert error_of(client.put(f"{route}/soft_limits", json=body), 422)["field"] == field


def test_soft_limits_are_set_at_rest(client: TestClient, route: str) -> None:
    client.post(f"{route}/move", json={"by_steps": 5000})
    assert "The motor moves" in error_of(limits(client, route, highest_steps=100), 409)["message"]
    client.post(f"{route}/halt")


def test_there_and_back_keeps_to_limits_that_are_set_in_a_pause(client: TestClient, route: str) -> None:
    client.post(f"{route}/there_and_back", json={"by_steps": 60, "times": 9, "pause_s": 0.5})
    until(lambda: client.get(route).json()["state"] == "ready")
    assert limits(client, route, lowest_steps=50, highest_steps=100).status_code == 200
    until(lambda: client.get(route).json()["shuttle"] is None)
    assert client.get(route).json()["position_steps"] == 60


def test_there_and_back_is_refused_when_it_ends_outside(client: TestClient, route: str) -> None:
    limits(client, route, lowest_steps=50, highest_steps=1000)
    refused = client.post(f"{route}/there_and_back", json={"by_steps": 200})
    assert "and this leads to 0" in error_of(refused, 422)["allowed"]


def test_a_run_that_is_asked_again_and_again_keeps_to_soft_limits(client: TestClient, route: str) -> None:
    limits(client, route, highest_steps=1500)
    run = {"speed_steps_per_s": 900, "for_s": 0.5}
    began = time.monotonic()
    while time.monotonic() - began < 3.0:
        client.post(f"{route}/run", json=run)
    until(lambda: client.get(route).json()["state"] == "ready")
    assert 800 < client.get(route).json()["position_steps"] <= 1500


def test_zeroing_is_not_for_axes_with_soft_limits(client: TestClient, route: str) -> None:
    limits(client, route, lowest_steps=0)
    error = error_of(client.post(f"{route}/zero", json={"steps": 100}), 422)
    assert (error["field"], error["value"]) == ("axes", 0)
