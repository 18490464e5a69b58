"""A FluidNC behind a real pseudo-terminal, over the API: connecting, trying, moving, stopping, importing."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from controllers.fluidnc.emulator import FILE, FluidNcOnACable
from designs import document
from http_api.families import connected, ok, wait_until


@pytest.fixture
def cable() -> Iterator[FluidNcOnACable]:
    with FluidNcOnACable() as cable:
        yield cable


@pytest.fixture
def route(client: TestClient, cable: FluidNcOnACable) -> str:
    return connected(client, cable.port, "fluidnc")


def test_from_connecting_to_rolling_back(
    client: TestClient, route: str, cable: FluidNcOnACable, tmp_path: Path
) -> None:
    device = client.get(route).json()
    assert device["capabilities"] == ["try", "line", "backup", "import"]
    assert (device["firmware_version"], device["most_axes"]) == ("v3.7.2", 3)
    kept = client.post(f"{route}/push", json={"design": document(), "to_axis": 0})
    assert kept.status_code == 409
    assert "can't store ramps" in kept.json()["errors"][0]["message"]
    pushed = ok(client.post(f"{route}/push", json={"design": document(), "to_axis": 0, "mode": "try"}))
    assert (pushed["verified"], pushed["kept"]) == (True, False)
    assert client.get(route).json()["on_trial"]
    [saved] = tmp_path.rglob("*.txt")
    assert "steps_per_mm: 250" in saved.read_text()
    ok(client.post(f"{route}/move", json={"by_steps": 1500}))
    device = wait_until(client, route, lambda device: device["axes"][0]["position_steps"] == 1500)
    ok(client.post(f"{route}/move", json={"by_steps": 20_000}))
    wait_until(client, route, lambda device: device["axes"][0]["position_steps"] > 2000)
    ok(client.post(f"{route}/stop"))
    at_rest = wait_until(client, route, lambda device: device["state"] == "ready")
    assert at_rest["axes"][0]["position_steps"] < 21_500
    ok(client.post(f"{route}/roll_back"))
    assert cable.fluidnc.settings[110] == 500
    assert not cable.fluidnc.has_written


def test_its_configuration_becomes_designs(client: TestClient, route: str) -> None:
    of_device = ok(client.post(f"{route}/import", json={"design": document()}))
    of_text = ok(client.post("/api/v1/import", json={"text": FILE, "design": document()}))
    assert of_text["family"] == "fluidnc"
    assert [axis["design"] for axis in of_device["axes"]] == [axis["design"] for axis in of_text["axes"]]
    answer = ok(client.post("/api/v1/families/fluidnc/ramp", json={"design": document(), "steps_per_mm": 250}))
    assert any("FluidNC works its intervals out itself" in loss for loss in answer["losses"])
