"""Families of controllers over the API: which there are, which one a device is of, and what it can't do."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from serial.tools import list_ports
from serial.tools.list_ports_common import ListPortInfo
from starlette.testclient import TestClient

from controllers.plain_controller import PLAIN
from designs import document
from stepramp.controllers.families import FAMILIES
from stepramp.http_api.app import create_app

DEVICES = "/api/v1/devices"
MOVE = [{"axis": 0, "by_steps": 5}]


@pytest.fixture
def client() -> Iterator[TestClient]:
    app = create_app(FAMILIES | {"plain": PLAIN})
    with TestClient(app, base_url="http://127.0.0.1:8000", raise_server_exceptions=False) as client:
        yield client


@pytest.fixture
def route(client: TestClient) -> str:
    device = client.post(DEVICES, json={"port": "plain wire", "family": "plain"}).json()
    return f"{DEVICES}/{device['id']}"


def test_the_families_are_told_with_the_ports(client: TestClient) -> None:
    families = client.get("/api/v1/ports").json()["families"]
    nothing = {"cannot": [], "plays_own": False, "reads_settings": False}
    ours = {"name": "stepramp", "title": "StepRamp", "kind": "stepramp", **nothing}
    assert families[0] == {**ours, "capabilities": list(FAMILIES["stepramp"].capabilities)}
    assert families[-1] == {"name": "plain", "title": "Plain", "kind": "plain", "capabilities": [], **nothing}
    grbl = next(family for family in families if family["name"] == "grbl")
    assert "Base speed: grbl starts from 0." in grbl["cannot"]
    assert (grbl["plays_own"], grbl["reads_settings"]) == (True, True)


def test_a_family_tells_what_its_controllers_can_do(client: TestClient) -> None:
    """As each tells itself once it is connected: see what is asserted of that in each family's own tests."""
    told = {each["name"]: each["capabilities"] for each in client.get("/api/v1/ports").json()["families"]}
    for family in FAMILIES.values():
        assert told[family.name] == list(family.capabilities)
    assert told["grbl"] == ["keep", "line", "backup", "import", "prove"]
    assert told["fluidnc"] == ["try", "line", "backup", "import"]
    assert told["klipper"] == told["marlin"] == ["keep", "try", "line", "backup", "import"]
    assert told["tmcl"] == ["keep", "try", "backup", "import"]


def test_each_port_tells_the_families_that_it_takes(client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    attached = ListPortInfo("/dev/ttyACM0")
    attached.description = "a board"
    monkeypatch.setattr(list_ports, "comports", lambda: [attached])
    taken = {each["port"]: each["families"] for each in client.get("/api/v1/ports").json()["ports"]}
    at_serial_ports = [name for name in FAMILIES if name != "klipper"]
    assert taken == {"/dev/ttyACM0": [*at_serial_ports, "plain"], "sim://": ["stepramp"]}


@pytest.mark.parametrize("family", ["tic", "plain"])
def test_the_virtual_port_takes_one_family_only(client: TestClient, family: str) -> None:
    refused = client.post(DEVICES, json={"port": "sim://", "family": family})
    [error] = refused.json()["errors"]
    assert (refused.status_code, error["field"], error["value"], error["allowed"]) == (
        422,
        "family",
        family,
        "stepramp",
    )
    assert client.get(DEVICES).json() == {"devices": []}


def test_a_device_tells_its_family_and_what_it_can_do(client: TestClient, route: str) -> None:
    device = client.get(route).json()
    assert (device["family"], device["capabilities"], device["state"]) == ("plain", [], "ready")
    assert (device["clocks_hz"], device["timer_hz"], device["starved"]) == ([], None, None)
    assert device["most_axes"] == 1
    preview = client.post(f"{route}/push/preview", json={"design": document()}).json()
    assert (preview["segments"], preview["bytes"]) == (None, 8)


def test_a_family_that_there_isnt(client: TestClient) -> None:
    refused = client.post(DEVICES, json={"port": "plain wire", "family": "plane"})
    [error] = refused.json()["errors"]
    allowed = ", ".join([*(name for name in FAMILIES if name != "klipper"), "plain"])
    assert (refused.status_code, error["field"], error["value"], error["allowed"]) == (422, "family", "plane", allowed)
    assert client.get(DEVICES).json() == {"devices": []}


def test_one_of_another_family_is_disconnected_first(client: TestClient, route: str) -> None:
    refused = client.post(DEVICES, json={"port": "plain wire"})
    assert refused.status_code == 409
    assert "disconnect it first" in refused.json()["errors"][0]["message"]
    assert client.get(route).json()["state"] == "ready"


HOME = {"axes": [{"axis": 0, "fast_steps_per_s": -100}], "slow_steps_per_s": 50}


@pytest.mark.parametrize(
    ("method", "path", "body", "words"),
    [
        ("POST", "push", {"design": document()}, "store ramps"),
        ("POST", "push", {"design": document(), "mode": "try"}, "try ramps without storing them"),
        ("POST", "keep", None, "store ramps"),
        ("POST", "roll_back", None, "try ramps without storing them"),
        ("POST", "restore", None, "bring back the ramps that it had before"),
        ("GET", "settings", None, "be given settings"),
        ("PUT", "settings", {}, "be given settings"),
        ("PUT", "settings", {"pulse_width_us": -1}, "be given settings"),
        ("POST", "line", {"axes": MOVE}, "move axes along a straight line"),
        ("POST", "zero", {"axes": [0], "steps": 5}, "zero gauges"),
        ("POST", "home", HOME, "tell of inputs, nor be homed from here"),
        ("POST", "acknowledge", None, "tell of inputs, nor be homed from here"),
        ("GET", "trace", None, "trace moves"),
        ("PUT", "trace", {"traced_axis": 0}, "trace moves"),
        ("GET", "backups", None, "be backed up"),
        ("POST", "backups", None, "be backed up"),
        ("POST", "import", {}, "tell settings that designs can be made of"),
    ],
)
def test_what_it_cant_do_is_refused(
    client: TestClient, route: str, method: str, path: str, body: Any, words: str
) -> None:
    refused = client.request(method, f"{route}/{path}", json=body)
    assert refused.status_code == 409
    assert f"can't {words}: no controller of its family, Plain, can." in refused.json()["errors"][0]["message"]


@pytest.mark.parametrize(("method", "body"), [("GET", None), ("PUT", {"emergency_stop": True})])
def test_what_is_around_it_is_real(client: TestClient, route: str, method: str, body: Any) -> None:
    refused = client.request(method, f"{route}/surroundings", json=body)
    assert refused.status_code == 409
    assert "is not virtual: what is at its inputs can't be pressed from here" in refused.text
    device = client.get(route).json()
    assert (device["inputs"], device["stopped_by"]) == (None, None)
    assert {(axis["position_known"], axis["homing"], axis["limits_hold"]) for axis in device["axes"]} == {
        (None, None, False)
    }
