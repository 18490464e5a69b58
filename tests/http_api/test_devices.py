from __future__ import annotations

import itertools
import time
from typing import Any

import pytest
from starlette.testclient import TestClient

from designs import document
from stepramp.controllers.virtual import VirtualController
from stepramp.http_api.app import create_app
from stepramp.link import protocol_sim

DEVICES = "/api/v1/devices"
LOCAL = {"host": "127.0.0.1:8000"}
PATIENCE_S = 10.0
DEVICE_FIELDS = {
    "id", "port", "name", "state", "message", "position_steps", "target_steps", "speed_steps_per_s", "timer_hz",
    "firmware_version", "ramp", "pushed",
}  # fmt: skip
_numbers = itertools.count()


@pytest.fixture
def port() -> str:
    """Return the port of a virtual controller without a ramp."""
    port = f"sim://http-{next(_numbers)}"
    protocol_sim.register(port, VirtualController())
    return port


@pytest.fixture
def device(client: TestClient, port: str) -> str:
    """Return the route of a device with a ramp."""
    connected = client.post(DEVICES, json={"port": port}).json()
    route = f"{DEVICES}/{connected['id']}"
    assert client.post(f"{route}/push", json={"design": document()}).status_code == 200
    return route


def wait_for(client: TestClient, route: str, state: str) -> dict[str, Any]:
    deadline = time.monotonic() + PATIENCE_S
    while (device := client.get(route).json())["state"] != state:
        assert time.monotonic() < deadline, device
        time.sleep(0.01)
    return device


def error_of(response: Any, status: int) -> dict[str, Any]:
    assert response.status_code == status, response.text
    [error] = response.json()["errors"]
    assert set(error) == {"field", "value", "allowed", "message"}
    return error


def test_the_virtual_port_is_last(client: TestClient) -> None:
    last = client.get("/api/v1/ports").json()["ports"][-1]
    assert last == {"port": "sim://", "name": "Virtual controller (nothing attached)", "virtual": True}


def test_connecting(client: TestClient, port: str) -> None:
    assert client.get(DEVICES).json() == {"devices": []}
    device = client.post(DEVICES, json={"port": port}).json()
    assert set(device) == DEVICE_FIELDS
    assert (device["id"], device["port"], device["state"], device["timer_hz"]) == ("1", port, "ready", 2_000_000)
    assert (device["ramp"], device["pushed"], device["message"]) == (None, None, None)
    assert client.post(DEVICES, json={"port": port}).json() == device
    assert client.get(f"{DEVICES}/1").json() == device
    assert client.get(DEVICES).json() == {"devices": [device]}


def test_the_virtual_controller_of_the_list_can_be_connected(client: TestClient) -> None:
    device = client.post(DEVICES, json={"port": "sim://"}).json()
    assert (device["name"], device["state"]) == ("Virtual controller", "ready")


def test_pushing(client: TestClient, port: str) -> None:
    client.post(DEVICES, json={"port": port})
    push = client.post(f"{DEVICES}/1/push", json={"design": document()}).json()
    assert push["verified"] is True
    slew = {"name": "Slew interval", "unit": "µs", "requested": "1,000.0", "sent": "1,000.0", "read_back": "1,000.0"}
    assert slew in push["items"]
    assert (push["largest_deviation_us"], push["sequence"], push["warnings"]) == (0.0, 1, [])
    device = client.get(f"{DEVICES}/1").json()
    assert device["pushed"] == push
    assert device["ramp"]["sequence"] == 1


def test_moving_and_stopping(client: TestClient, device: str) -> None:
    moving = client.post(f"{device}/move", json={"by_steps": -5000}).json()
    assert (moving["state"], moving["target_steps"]) == ("moving", -5000)
    stopping = client.post(f"{device}/stop").json()
    assert stopping["state"] in ("stopping", "ready")
    stopped = wait_for(client, device, "ready")
    assert stopped["position_steps"] == stopped["target_steps"] < 0
    client.post(f"{device}/move", json={"to_steps": 5000})
    halted = client.post(f"{device}/halt").json()
    assert (halted["state"], halted["speed_steps_per_s"]) == ("ready", 0.0)


def test_stopping_all(client: TestClient, device: str) -> None:
    client.post(f"{device}/move", json={"by_steps": 5000})
    [stopped] = client.post(f"{DEVICES}/stop").json()["devices"]
    assert stopped["state"] == "stopping"


def test_what_is_refused_while_moving(client: TestClient, device: str) -> None:
    client.post(f"{device}/move", json={"by_steps": 5000})
    for response in (
        client.delete(device),
        client.post(f"{device}/push", json={"design": document()}),
        client.post(f"{device}/move", json={"by_steps": 1}),
    ):
        assert "The motor moves" in error_of(response, 409)["message"]
    client.post(f"{device}/halt")
    assert client.delete(device).json() == {}
    assert client.get(DEVICES).json() == {"devices": []}


def test_moving_without_a_ramp(client: TestClient, port: str) -> None:
    client.post(DEVICES, json={"port": port})
    assert "no ramp" in error_of(client.post(f"{DEVICES}/1/move", json={"by_steps": 1}), 409)["message"]


def test_no_such_device(client: TestClient) -> None:
    for method, route, body in (
        ("GET", "", None),
        ("DELETE", "", None),
        ("POST", "/push", {"design": document()}),
        ("POST", "/move", {"by_steps": 1}),
        ("POST", "/stop", None),
        ("POST", "/halt", None),
    ):
        error = error_of(client.request(method, f"{DEVICES}/7{route}", json=body), 404)
        assert "no device '7'" in error["message"]


def test_a_port_that_isnt_there(client: TestClient) -> None:
    error = error_of(client.post(DEVICES, json={"port": "/dev/there-is-none"}), 502)
    assert "/dev/there-is-none" in error["message"]
    assert client.get(DEVICES).json() == {"devices": []}


@pytest.mark.parametrize(
    ("body", "field"),
    [
        ({}, "port"),
        ({"port": 5}, "port"),
        ({"port": "spy://x"}, "port"),
        ({"port": "sim://", "baud": 9600}, "baud"),
    ],
)
def test_ports_that_cant_be_used(client: TestClient, body: dict[str, Any], field: str) -> None:
    assert error_of(client.post(DEVICES, json=body), 422)["field"] == field


@pytest.mark.parametrize(
    ("body", "field"),
    [
        ({}, "by_steps"),
        ({"by_steps": 0}, "by_steps"),
        ({"by_steps": 1.5}, "by_steps"),
        ({"by_steps": 2**31}, "by_steps"),
        ({"by_steps": 1, "to_steps": 1}, "to_steps"),
        ({"to_steps": -(2**31) - 1}, "to_steps"),
        ({"steps": 1, "by_steps": 1}, "steps"),
    ],
)
def test_moves_that_cant_be_made(client: TestClient, device: str, body: dict[str, Any], field: str) -> None:
    error = error_of(client.post(f"{device}/move", json=body), 422)
    assert error["field"] == field
    assert error["allowed"]


def test_a_target_that_only_the_device_knows_to_be_too_far(client: TestClient, device: str) -> None:
    client.post(f"{device}/move", json={"by_steps": 1})
    wait_for(client, device, "ready")
    error = error_of(client.post(f"{device}/move", json={"by_steps": 2**31 - 1}), 422)
    assert (error["field"], error["value"]) == ("by_steps", 2**31 - 1)


def test_a_design_that_the_controller_cant_play(client: TestClient, device: str) -> None:
    design = document(ramp__slew_speed_steps_per_s=60_000)
    error = error_of(client.post(f"{device}/push", json={"design": design}), 422)
    assert error["field"] == "design.ramp.slew_speed_steps_per_s"
    assert "to 50,000 steps/s with this controller" in error["allowed"]


def test_the_socket_tells_all_at_once_and_then_each_change(client: TestClient, device: str) -> None:
    with client.websocket_connect(f"{DEVICES}/events", headers=LOCAL) as socket:
        [first] = socket.receive_json()["devices"]
        assert set(first) == DEVICE_FIELDS
        client.post(f"{device}/move", json={"by_steps": 100})
        heard = [first]
        while heard[-1]["position_steps"] != 100 or heard[-1]["state"] != "ready":
            heard += socket.receive_json()["devices"]
        positions = [each["position_steps"] for each in heard]
        assert positions == sorted(positions)
        assert "moving" in {each["state"] for each in heard}
        client.delete(device)
        while socket.receive_json()["devices"]:
            pass


def test_a_lost_device_is_told_and_can_be_connected_again(client: TestClient, port: str) -> None:
    virtual = VirtualController()
    protocol_sim.register(port, virtual)
    client.post(DEVICES, json={"port": port})
    virtual.opened()  # The board is reset: it forgets the session.
    lost = wait_for(client, f"{DEVICES}/1", "lost")
    assert "was restarted" in lost["message"]
    assert "was restarted" in error_of(client.post(f"{DEVICES}/1/stop"), 502)["message"]
    assert client.post(DEVICES, json={"port": port}).json()["state"] == "ready"


def test_the_end_of_the_server_lets_go_of_the_devices(port: str) -> None:
    for _ in range(2):
        with TestClient(create_app(), base_url="http://127.0.0.1:8000") as client:
            assert client.post(DEVICES, json={"port": port}).status_code == 200
