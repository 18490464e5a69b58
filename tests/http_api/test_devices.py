from __future__ import annotations

import itertools
import socket
import time
from typing import Any

import pytest
from starlette.testclient import TestClient

from designs import document
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.http_api.app import create_app
from stepramp.link import protocol_sim
from stepramp.link.remote_ports import RemotePorts

DEVICES = "/api/v1/devices"
LOCAL = {"host": "127.0.0.1:8000"}
PATIENCE_S = 10.0
DEVICE_FIELDS = {
    "id", "port", "name", "family", "capabilities", "state", "message", "position_steps", "target_steps",
    "speed_steps_per_s", "axes", "timer_hz", "clocks_hz", "most_axes", "firmware_version", "ramp", "on_trial", "backup",
    "lacks_backup", "motors_on", "starved", "pushed", "progress", "shuttle", "unknown_positions", "in_control",
    "in_control_at", "stops", "heard_s", "age_s", "unproven", "unproven_words", "proving", "proof",
    "inputs", "stopped_by",
}  # fmt: skip
AXIS_FIELDS = {
    "axis", "state", "position_steps", "target_steps", "speed_steps_per_s", "steps_made", "lowest_steps",
    "highest_steps", "is_beyond_limits", "steps_per_mm", "microsteps", "limits_hold", "position_known", "homing",
    "position_told",
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


@pytest.fixture
def four_axes(client: TestClient, port: str) -> str:
    """Return the route of a device with four axes, of which axis 1 is slower than the others."""
    connected = client.post(DEVICES, json={"port": port}).json()
    route = f"{DEVICES}/{connected['id']}"
    slower = document(ramp__slew_speed_steps_per_s=500)
    pushed = client.post(f"{route}/push", json={"axes": [document(), slower, document(), document()]})
    assert pushed.status_code == 200, pushed.text
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
    assert {"field", "value", "allowed", "message"} <= set(error)
    return error


def test_the_virtual_port_is_last(client: TestClient) -> None:
    last = client.get("/api/v1/ports").json()["ports"][-1]
    assert last == {"port": "sim://", "name": "Virtual (nothing attached)", "virtual": True, "families": ["stepramp"]}


def test_connecting(client: TestClient, port: str) -> None:
    assert client.get(DEVICES).json() == {"devices": []}
    device = client.post(DEVICES, json={"port": port}).json()
    assert set(device) == DEVICE_FIELDS
    assert (device["id"], device["port"], device["state"], device["timer_hz"]) == ("1", port, "ready", 2_000_000)
    assert (device["ramp"], device["pushed"], device["message"]) == (None, None, None)
    assert (device["clocks_hz"], device["on_trial"], device["most_axes"]) == ([16_000_000, 2_000_000], False, 4)
    assert device["family"] == "stepramp"
    assert set(device["capabilities"]) == {"keep", "try", "restore", "settings", "trace", "line", "zero", "inputs"}
    [axis] = device["axes"]
    assert set(axis) == AXIS_FIELDS
    assert 0 <= device.pop("age_s") < PATIENCE_S
    assert client.post(DEVICES, json={"port": port}).json().items() > device.items()
    assert client.get(f"{DEVICES}/1").json().items() > device.items()
    assert client.get(DEVICES).json()["devices"][0].items() > device.items()


def test_the_virtual_controller_of_the_list_can_be_connected(client: TestClient) -> None:
    device = client.post(DEVICES, json={"port": "sim://"}).json()
    assert (device["name"], device["state"]) == ("Virtual controller", "ready")


def test_pushing(client: TestClient, port: str) -> None:
    before = client.post(DEVICES, json={"port": port}).json()
    push = client.post(f"{DEVICES}/1/push", json={"design": document()}).json()
    assert push["heard_s"] > before["heard_s"], "what was told before says nothing of these ramps"
    assert push["verified"] is True
    figures = {"requested": 1000.0, "sent": 1000.0, "read_back": 1000.0}
    assert {"name": "Slew interval", "unit": "µs", "axis": 0, "own": None, **figures} in push["items"]
    assert (push["largest_deviation_us"], push["sequence"], push["warnings"]) == (0.0, 1, [])
    assert push["kept"] is True
    device = client.get(f"{DEVICES}/1").json()
    assert device["pushed"].items() < push.items()
    assert device["heard_s"] >= push["heard_s"]
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
    assert stopped["state"] in ("stopping", "ready")
    assert wait_for(client, device, "ready")["position_steps"] < 5000


def test_what_is_refused_while_moving(client: TestClient, device: str) -> None:
    client.post(f"{device}/move", json={"by_steps": 5000})
    for response in (
        client.delete(device),
        client.post(f"{device}/push", json={"design": document()}),
        client.post(f"{device}/keep"),
        client.post(f"{device}/roll_back"),
        client.post(f"{device}/restore"),
        client.put(f"{device}/settings", json={}),
        client.post(f"{device}/position", json={"position_steps": 0}),
        client.post(f"{device}/zero", json={"steps": 10}),
        client.post(f"{device}/line", json={"axes": [{"axis": 0, "by_steps": 1}]}),
    ):
        assert "The motor moves" in error_of(response, 409)["message"]
    client.post(f"{device}/halt")
    assert client.delete(device).json() == {}
    assert client.get(DEVICES).json() == {"devices": []}


def test_changing_a_move_on_its_way(client: TestClient, device: str) -> None:
    client.post(f"{device}/move", json={"by_steps": 5000})
    moving = client.post(f"{device}/move", json={"to_steps": -20}).json()
    assert (moving["state"], moving["target_steps"]) == ("moving", -20)
    assert wait_for(client, device, "ready")["position_steps"] == -20


def test_running_at_a_speed(client: TestClient, device: str) -> None:
    running = client.post(f"{device}/run", json={"speed_steps_per_s": -400}).json()
    assert running["state"] == "moving"
    deadline = time.monotonic() + PATIENCE_S
    while client.get(device).json()["speed_steps_per_s"] != 400:
        assert time.monotonic() < deadline
    assert client.get(device).json()["position_steps"] < 0
    client.post(f"{device}/run", json={"axes": [{"axis": 0, "speed_steps_per_s": 0}]})
    stopped = wait_for(client, device, "ready")
    assert stopped["target_steps"] == stopped["position_steps"] < 0


def positions(device: dict[str, Any]) -> list[int]:
    return [axis["position_steps"] for axis in device["axes"]]


def test_four_axes_at_a_time(client: TestClient, four_axes: str) -> None:
    moves = [{"axis": 0, "by_steps": 100}, {"axis": 3, "by_steps": -60}]
    moving = client.post(f"{four_axes}/move", json={"axes": moves}).json()
    assert [axis["state"] for axis in moving["axes"]] == ["moving", "ready", "ready", "moving"]
    assert [axis["target_steps"] for axis in moving["axes"]] == [100, 0, 0, -60]
    client.post(f"{four_axes}/move", json={"axes": [{"axis": 1, "to_steps": 30}]})
    assert positions(wait_for(client, four_axes, "ready")) == [100, 30, 0, -60]
    client.post(f"{four_axes}/move", json={"axes": [{"axis": each, "by_steps": 5000} for each in (0, 2)]})
    client.post(f"{four_axes}/halt", json={"axes": [2]})
    halted = client.get(four_axes).json()
    assert [halted["axes"][axis]["state"] for axis in (0, 2)] == ["moving", "ready"]
    client.post(f"{four_axes}/stop", json={})
    assert wait_for(client, four_axes, "ready")["position_steps"] < 5100


def test_a_line(client: TestClient, four_axes: str) -> None:
    axes = [{"axis": 0, "by_steps": 90}, {"axis": 1, "by_steps": -30}, {"axis": 3, "by_steps": 0}]
    moving = client.post(f"{four_axes}/line", json={"axes": axes}).json()
    assert moving["state"] == "moving"
    assert "The motor moves" in error_of(client.post(f"{four_axes}/move", json={"by_steps": 1}), 409)["message"]
    assert positions(wait_for(client, four_axes, "ready")) == [90, -30, 0, 0]
    client.post(f"{four_axes}/line", json={"axes": axes, "ramp_axis": 2})
    assert positions(wait_for(client, four_axes, "ready")) == [180, -60, 0, 0]


def test_positions_and_gauges(client: TestClient, four_axes: str) -> None:
    named = client.post(f"{four_axes}/position", json={"position_steps": -77}).json()
    assert (named["state"], named["position_steps"], named["target_steps"]) == ("ready", -77, -77)
    axes = [{"axis": 1, "position_steps": 5}, {"axis": 2, "position_steps": 6}]
    assert positions(client.post(f"{four_axes}/position", json={"axes": axes}).json()) == [-77, 5, 6, 0]
    zeroing = client.post(f"{four_axes}/zero", json={"axes": [2], "steps": 40}).json()
    assert zeroing["axes"][2]["target_steps"] == 0
    ready = wait_for(client, four_axes, "ready")
    assert (positions(ready), ready["axes"][2]["steps_made"]) == ([-77, 5, 0, 0], 40)


def test_trying_keeping_and_bringing_back(client: TestClient, device: str) -> None:
    slower = {"design": document(ramp__slew_speed_steps_per_s=500), "mode": "try"}
    pushed = client.post(f"{device}/push", json=slower).json()
    assert (pushed["kept"], pushed["sequence"]) == (False, 1)
    assert client.get(device).json()["on_trial"] is True
    assert client.post(f"{device}/roll_back").json()["on_trial"] is False
    assert "Nothing is on trial" in error_of(client.post(f"{device}/roll_back"), 409)["message"]
    assert "stored before" in error_of(client.post(f"{device}/restore"), 409)["message"]
    client.post(f"{device}/push", json=slower | {"to_axis": 1})
    kept = client.post(f"{device}/keep").json()
    assert (kept["on_trial"], kept["ramp"]["sequence"], len(kept["axes"])) == (False, 2, 2)
    restored = client.post(f"{device}/restore").json()
    assert (restored["ramp"]["sequence"], len(restored["axes"])) == (3, 1)


def test_settings(client: TestClient, device: str) -> None:
    defaults = client.get(f"{device}/settings").json()
    assert (defaults["outputs"], defaults["pulse_width_us"], defaults["enable_hold_ms"]) == (
        "step_and_direction",
        0,
        None,
    )
    used = client.put(f"{device}/settings", json={"pulse_width_us": 5, "direction_inverted": [2, 0]}).json()
    assert used == defaults | {"pulse_width_us": 5, "direction_inverted": [0, 2]}
    assert client.get(f"{device}/settings").json() == used
    assert client.get(device).json()["on_trial"] is True
    client.post(f"{device}/keep")
    assert client.get(device).json()["on_trial"] is False


@pytest.mark.parametrize(
    ("body", "field", "value"),
    [
        ({"pulse_width_us": 101}, "pulse_width_us", 101),
        ({"pulse_width_us": 101, "enable_lead_ms": 1}, "pulse_width_us", 101),
        ({"outputs": "relays"}, "outputs", "relays"),
        ({"step_inverted": [4]}, "step_inverted.0", 4),
        ({"step_inverted": None}, "step_inverted", None),
        ({"enable_level": True}, "enable_level", True),
        ({"pulse": 1}, "pulse", 1),
        ({"name": 1}, "name", 1),
    ],
)
def test_settings_that_cant_be(
    client: TestClient, device: str, body: dict[str, Any], field: str, value: object
) -> None:
    error = error_of(client.put(f"{device}/settings", json=body), 422)
    assert (error["field"], error["value"]) == (field, value)
    assert error["allowed"]


def test_a_trace(client: TestClient, four_axes: str) -> None:
    assert "No move has been traced" in error_of(client.get(f"{four_axes}/trace"), 409)["message"]
    armed = client.put(f"{four_axes}/trace", json={"traced_axis": 2, "every_steps": 3}).json()
    assert armed == {"traced_axis": 2, "every_steps": 3, "next_number": 1}
    client.post(f"{four_axes}/move", json={"axes": [{"axis": 2, "by_steps": -100}]})
    wait_for(client, four_axes, "ready")
    trace = client.get(f"{four_axes}/trace").json()
    assert (trace["traced_axis"], trace["complete"], trace["changed"], trace["timer_hz"]) == (2, True, False, 2_000_000)
    assert (trace["number"], trace["step"]) == (1, list(range(1, 101, 3)))
    planned = client.post("/api/v1/profile", json={"design": document(move__steps=100)}).json()
    instants = [0, *itertools.accumulate(planned["intervals_ticks"])]
    assert trace["planned_ticks"] == trace["measured_ticks"] == instants[0:100:3]
    assert trace["deviation_us"] == [0.0] * 34
    off = client.put(f"{four_axes}/trace", json={"traced_axis": None}).json()
    assert off["traced_axis"] is None


def test_axes_that_are_too_fast_together(client: TestClient, port: str) -> None:
    device = f"{DEVICES}/{client.post(DEVICES, json={'port': port}).json()['id']}"
    quick = document(
        timer__frequency_hz=16_000_000, ramp__slew_speed_steps_per_s=35_000, ramp__acceleration_steps_per_s2=1e9
    )
    pushed = client.post(f"{device}/push", json={"axes": [quick] * 4}).json()
    assert "117 %" in pushed["warnings"][0]
    moves = {"axes": [{"axis": axis, "by_steps": 5} for axis in range(4)]}
    error = error_of(client.post(f"{device}/move", json=moves), 422)
    assert (error["field"], error["value"]) == ("axes", "0, 1, 2, 3")
    assert "117 %" in error["allowed"]
    del moves["axes"][3]
    assert client.post(f"{device}/move", json=moves).status_code == 200


def test_moving_without_a_ramp(client: TestClient, port: str) -> None:
    client.post(DEVICES, json={"port": port})
    assert "no ramp" in error_of(client.post(f"{DEVICES}/1/move", json={"by_steps": 1}), 409)["message"]


def test_no_such_device(client: TestClient) -> None:
    for method, route, body in (
        ("GET", "", None),
        ("DELETE", "", None),
        ("POST", "/push", {"design": document()}),
        ("POST", "/move", {"by_steps": 1}),
        ("POST", "/run", {"speed_steps_per_s": 1}),
        ("POST", "/line", {"axes": [{"axis": 0, "by_steps": 1}]}),
        ("POST", "/position", {"position_steps": 1}),
        ("POST", "/zero", {"steps": 1}),
        ("POST", "/keep", None),
        ("POST", "/roll_back", None),
        ("POST", "/restore", None),
        ("GET", "/settings", None),
        ("PUT", "/settings", {}),
        ("GET", "/trace", None),
        ("PUT", "/trace", {"traced_axis": None}),
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
        ({"port": ""}, "port"),
        ({"port": "."}, "port"),
        ({"port": "/dev"}, "port"),
        ({"port": "a\0b"}, "port"),
        ({"port": "x" * 201}, "port"),
        ({"port": "socket://bad"}, "port"),
        ({"port": "socket://h:99999"}, "port"),
        ({"port": "socket://127.0.0.1:22"}, "port"),
        ({"port": "rfc2217://169.254.169.254:80"}, "port"),
        ({"port": "sim://", "baud": 9600}, "baud"),
    ],
)
def test_ports_that_cant_be_used(client: TestClient, body: dict[str, Any], field: str) -> None:
    assert error_of(client.post(DEVICES, json=body), 422)["field"] == field
    assert client.get(DEVICES).json() == {"devices": []}


def test_only_remote_ports_that_were_named_at_start_are_offered_and_reached() -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        other.setblocking(False)
        number = other.getsockname()[1]
        app = create_app(remote_ports=RemotePorts.named(["printer.local:2217"]))
        with TestClient(app, base_url="http://127.0.0.1:8000") as client:
            offered = [each["port"] for each in client.get("/api/v1/ports").json()["ports"]]
            ways = [f"{scheme}://printer.local:2217" for scheme in ("rfc2217", "socket", "moonraker")]
            assert offered[-4:] == [*ways, "sim://"]
            address = f"socket://127.0.0.1:{number}"
            error = error_of(client.post(DEVICES, json={"port": address}), 422)
            assert (error["field"], error["value"]) == ("port", address)
            assert error["allowed"].endswith("only hosts named at start by --allow-remote-port: printer.local:2217")
            assert client.get(DEVICES).json() == {"devices": []}
        with pytest.raises(BlockingIOError):
            other.accept()


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
        ({"axes": []}, "axes"),
        ({"axes": None}, "by_steps"),
        ({"axes": 3}, "axes"),
        ({"axes": [{"axis": 0}]}, "axes.0.by_steps"),
        ({"axes": [{"axis": 0, "by_steps": 1, "to_steps": 1}]}, "axes.0.to_steps"),
        ({"axes": [{"axis": 0, "by_steps": 1}, {"axis": 1, "to_steps": 1}]}, "axes.1.by_steps"),
        ({"axes": [{"axis": 4, "by_steps": 1}]}, "axes.0.axis"),
        ({"axes": [{"axis": 1, "by_steps": 1}]}, "axes.0.axis"),
        ({"axes": [{"axis": 0, "by_steps": 1}] * 2}, "axes.1.axis"),
        ({"axes": [{"axis": 0, "by_steps": 1}], "by_steps": 1}, "by_steps"),
    ],
)
def test_moves_that_cant_be_made(client: TestClient, device: str, body: dict[str, Any], field: str) -> None:
    error = error_of(client.post(f"{device}/move", json=body), 422)
    assert error["field"] == field
    assert error["allowed"]


@pytest.mark.parametrize(
    ("route", "body", "field"),
    [
        ("run", {}, "speed_steps_per_s"),
        ("run", {"speed_steps_per_s": 1001.5}, "speed_steps_per_s"),
        ("run", {"speed_steps_per_s": 1e-5}, "speed_steps_per_s"),
        ("run", {"speed_steps_per_s": 1e-310}, "speed_steps_per_s"),
        ("run", {"axes": [{"axis": 0, "speed_steps_per_s": -2000}]}, "axes.0.speed_steps_per_s"),
        ("line", {}, "axes"),
        ("line", {"axes": [{"axis": 0, "by_steps": 0}]}, "axes.0.by_steps"),
        ("line", {"axes": [{"axis": 0, "by_steps": 5}], "ramp_axis": 1}, "ramp_axis"),
        ("position", {}, "position_steps"),
        ("position", {"position_steps": 2**31}, "position_steps"),
        ("zero", {}, "steps"),
        ("zero", {"steps": 65_536}, "steps"),
        ("zero", {"steps": 5, "axes": []}, "axes"),
        ("zero", {"steps": 5, "axes": [2]}, "axes"),
        ("zero", {"steps": 5, "axes": [0, 0]}, "axes"),
        ("push", {}, "design"),
        ("push", {"design": document(), "axes": [document()]}, "axes"),
        ("push", {"design": document(), "to_axis": 2}, "to_axis"),
        ("push", {"design": document(), "mode": "maybe"}, "mode"),
        ("push", {"axes": []}, "axes"),
        ("push", {"axes": [document(move__steps=0)]}, "axes.0.move.steps"),
        ("push", {"axes": [document(), document(ramp__slew_speed_steps_per_s=200_000)]},
         "axes.1.ramp.slew_speed_steps_per_s"),
        ("push", {"axes": [document(timer__frequency_hz=1_000_000)]}, "axes.0.timer.frequency_hz"),
        ("push", {"design": document(timer__frequency_hz=1_000_000)}, "design.timer.frequency_hz"),
    ],
)  # fmt: skip
def test_what_cant_be_asked_for(client: TestClient, device: str, route: str, body: dict[str, Any], field: str) -> None:
    error = error_of(client.post(f"{device}/{route}", json=body), 422)
    assert error["field"] == field
    assert error["allowed"]
    assert client.get(device).json()["state"] == "ready"


@pytest.mark.parametrize(("body", "field"), [({}, "traced_axis"), ({"traced_axis": 3}, "traced_axis")])
def test_what_cant_be_traced(client: TestClient, device: str, body: dict[str, Any], field: str) -> None:
    assert error_of(client.put(f"{device}/trace", json=body), 422)["field"] == field


def test_a_target_that_only_the_device_knows_to_be_too_far(client: TestClient, device: str) -> None:
    client.post(f"{device}/move", json={"by_steps": 1})
    wait_for(client, device, "ready")
    error = error_of(client.post(f"{device}/move", json={"by_steps": 2**31 - 1}), 422)
    assert (error["field"], error["value"]) == ("by_steps", 2**31 - 1)


def test_a_design_that_the_controller_cant_play(client: TestClient, device: str) -> None:
    design = document(ramp__slew_speed_steps_per_s=160_000)
    error = error_of(client.post(f"{device}/push", json={"design": design}), 422)
    assert error["field"] == "design.ramp.slew_speed_steps_per_s"
    assert "to 142,857.1428 steps/s with this controller" in error["allowed"]


@pytest.mark.parametrize("what", ["push/preview", "push"])
def test_a_design_that_is_too_long_is_refused_with_what_would_be_accepted(
    client: TestClient, device: str, what: str
) -> None:
    def body() -> dict[str, Any]:
        return {"design": document(ramp__acceleration_steps_per_s2=14, ramp__deceleration_steps_per_s2=22)}

    error = error_of(client.post(f"{device}/{what}", json=body()), 422)
    assert error["field"] == "design.ramp.acceleration_steps_per_s2"
    assert error["message"] == error["reason"]
    assert " of 250 segments, " in error["reason"]
    assert [remedy["text"].split()[0] for remedy in error["remedies"]] == ["raise", "lower", "use"]
    for remedy in error["remedies"]:
        wanted = body()
        for change in remedy["changes"]:
            root, part, name = change["field"].split(".")
            wanted[root][part][name] = change["value"]
        assert client.post(f"{device}/push/preview", json=wanted).status_code == 200


def test_the_socket_tells_all_at_once_and_then_each_change(client: TestClient, device: str) -> None:
    with client.websocket_connect(f"{DEVICES}/events", headers=LOCAL) as socket:
        [first] = socket.receive_json()["devices"]
        assert set(first) == DEVICE_FIELDS
        client.post(f"{device}/move", json={"by_steps": 100})
        heard = [first]
        while heard[-1]["position_steps"] != 100 or heard[-1]["state"] != "ready":
            heard += socket.receive_json()["devices"]
        places = [each["position_steps"] for each in heard]
        assert places == sorted(places)
        assert places == [each["axes"][0]["position_steps"] for each in heard]
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
    for route in ("stop", "halt"):
        message = error_of(client.post(f"{DEVICES}/1/{route}"), 502)["message"]
        assert "was restarted" in message
        assert message.endswith(". It is stopped as soon as it answers.")
    assert client.post(DEVICES, json={"port": port}).json()["state"] == "ready"


def test_the_end_of_the_server_lets_go_of_the_devices(port: str) -> None:
    for _ in range(2):
        with TestClient(create_app(), base_url="http://127.0.0.1:8000") as client:
            assert client.post(DEVICES, json={"port": port}).status_code == 200
