"""Inputs, homing and what must be acknowledged over HTTP, with the virtual controller and its surroundings."""

from __future__ import annotations

from typing import Any

import pytest
from starlette.testclient import TestClient

from http_api.two_axes import LOCAL, device_of, error_of
from waiting import until

ROLES = [
    {"input": "A0", "role": "emergency_stop", "active": "high"},
    {"input": "A1", "role": "driver_fault", "pull_up": False},
    {"input": "A2", "role": "limit", "axis": 0, "end": "low"},
    {"input": "D9", "role": "limit", "axis": 1, "end": "high", "stops": "at_once"},
]
HOME = {"axes": [{"axis": 0, "fast_steps_per_s": -900}], "slow_steps_per_s": 300, "back_off_steps": 20}
"""Axis 0 to a switch that is 200 steps away."""


@pytest.fixture
def route(client: TestClient) -> str:
    """Return the route of a device with two axes, and inputs."""
    route = device_of(lambda method, path, body: client.request(method, path, json=body).json())
    assert client.put(f"{route}/settings", json={"inputs": ROLES}).status_code == 200
    changed = client.put(f"{route}/surroundings", json={"axes": [{"axis": 0, "low_steps": -200, "high_steps": None}]})
    assert changed.status_code == 200, changed.text
    return route


def axis_of(client: TestClient, route: str, axis: int = 0) -> dict[str, Any]:
    return dict(client.get(route).json()["axes"][axis])


def test_settings_say_what_inputs_are_for(client: TestClient, route: str) -> None:
    settings = client.get(f"{route}/settings").json()
    common = {"active": "low", "pull_up": True, "axis": None, "end": None, "stops": None}
    assert settings["inputs"] == [
        {**common, "input": "A0", "role": "emergency_stop", "active": "high"},
        {**common, "input": "A1", "role": "driver_fault", "pull_up": False},
        {**common, "input": "A2", "role": "limit", "axis": 0, "end": "low", "stops": "ramp"},
        {**common, "input": "D9", "role": "limit", "axis": 1, "end": "high", "stops": "at_once"},
    ]
    assert (settings["silence_s"], settings["silence_ends_moves"], settings["looks"]) == (1.024, False, 4)
    taken = client.put(f"{route}/settings", json={"silence_s": 2.0, "pulse_width_us": 3}).json()
    assert (taken["silence_s"], taken["pulse_width_us"]) == (2.048, 3), "in steps of 0.256 s"
    assert taken["inputs"] == settings["inputs"], "what isn't given stays as it is"
    # As a page does that changes something else.
    assert client.put(f"{route}/settings", json=taken).json() == taken


@pytest.mark.parametrize(
    ("body", "field"),
    [
        ({"silence_s": 60}, "silence_s"),
        ({"looks": 11}, "looks"),
        ({"inputs": [{"input": "D9", "role": "emergency_stop"}]}, "inputs.0.input"),
        ({"inputs": [{"input": "A0", "role": "limit", "end": "low"}]}, "inputs.0.axis"),
        ({"inputs": [ROLES[0], ROLES[0]]}, "inputs.1.input"),
    ],
)
def test_settings_of_inputs_that_cant_be(client: TestClient, route: str, body: Any, field: str) -> None:
    assert error_of(client.put(f"{route}/settings", json=body), 422)["field"] == field


def test_what_a_device_says_of_its_inputs(client: TestClient, route: str) -> None:
    device = client.get(route).json()
    assert device["stopped_by"] == []
    assert device["inputs"][3] == {
        "input": "D9", "role": "limit", "is_active": False, "active": "low", "pull_up": True,
        "axis": 1, "end": "high", "stops": "at_once",
    }  # fmt: skip
    assert [(axis["position_known"], axis["homing"]) for axis in device["axes"]] == [(False, False)] * 2
    moved = client.post(f"{route}/position", json={"position_steps": 7}).json()["axes"][0]
    assert (moved["position_known"], moved["position_steps"]) == (True, 7)


def test_homing(client: TestClient, route: str) -> None:
    client.put(f"{route}/soft_limits", json={"axes": [{"axis": 0, "lowest_steps": 0, "highest_steps": 2000}]})
    body = {**HOME, "axes": [{**HOME["axes"][0], "position_steps": 50}]}
    begun = client.post(f"{route}/home", json=body).json()
    assert (begun["state"], begun["axes"][0]["homing"], begun["axes"][0]["limits_hold"]) == ("moving", True, False)
    assert error_of(client.post(f"{route}/move", json={"by_steps": 3}), 409)["message"].startswith("The motor moves")
    until(lambda: axis_of(client, route)["position_steps"] == 49)
    axis = axis_of(client, route)
    assert (axis["homing"], axis["position_known"], axis["limits_hold"]) == (False, True, True)
    client.post(f"{route}/move", json={"to_steps": 50})
    until(lambda: axis_of(client, route)["position_steps"] == 50)
    assert client.get(f"{route}/surroundings").json()["axes"][0]["place_steps"] == -199


@pytest.mark.parametrize("stop", ["stop", "halt"])
def test_a_stop_ends_a_homing_and_what_was_asked_before_begins_none(client: TestClient, route: str, stop: str) -> None:
    before = client.get(route).json()["stops"]
    client.post(f"{route}/home", json=HOME)
    client.post(f"{route}/{stop}")
    until(lambda: client.get(route).json()["state"] == "ready")
    axis = axis_of(client, route)
    assert (axis["homing"], axis["position_known"]) == (False, False)
    headers = {"X-StepRamp-Stops": str(before)}
    for path, body in (("home", HOME), ("acknowledge", None)):
        refused = client.post(f"{route}/{path}", json=body, headers=headers)
        assert error_of(refused, 409)["message"].startswith("A stop came first"), path
    assert axis_of(client, route)["position_steps"] == axis["position_steps"]


def test_a_homing_ends_with_the_page_that_began_it(client: TestClient, route: str) -> None:
    client.put(f"{route}/surroundings", json={"axes": [{"axis": 0, "low_steps": -100_000}]})
    with client.websocket_connect("/api/v1/devices/events?page=one", headers=LOCAL) as socket:
        socket.receive_json()
        assert client.post(f"{route}/home", json=HOME, headers={"X-StepRamp-Page": "one"}).status_code == 200
        until(lambda: axis_of(client, route)["homing"])
    until(lambda: client.get(route).json()["state"] == "ready")
    assert (axis_of(client, route)["homing"], axis_of(client, route)["position_known"]) == (False, False)


def test_a_homing_ends_after_its_time(client: TestClient, route: str) -> None:
    client.put(f"{route}/surroundings", json={"axes": [{"axis": 0, "low_steps": -100_000}]})
    assert client.post(f"{route}/home", json={**HOME, "for_s": 0.3}).status_code == 200
    until(lambda: client.get(route).json()["state"] == "ready")
    axis = axis_of(client, route)
    assert (axis["homing"], axis["position_known"]) == (False, False)
    assert -2000 < axis["position_steps"] < 0


@pytest.mark.parametrize(("pressed", "where"), [("emergency_stop", "A0"), ("driver_fault", "A1")])
def test_what_stops_all_must_be_acknowledged(client: TestClient, route: str, pressed: str, where: str) -> None:
    client.post(f"{route}/run", json={"speed_steps_per_s": 500, "for_s": 60})
    client.put(f"{route}/surroundings", json={pressed: True})
    until(lambda: client.get(route).json()["state"] == "ready")
    device = client.get(route).json()
    assert device["stopped_by"] == [pressed]
    assert [each["input"] for each in device["inputs"] if each["is_active"]] == [where]
    assert where in device["message"]
    for path, body in (("move", {"by_steps": 5}), ("home", HOME), ("acknowledge", None)):
        assert f"at {where} is active" in error_of(client.post(f"{route}/{path}", json=body), 409)["message"], path
    assert client.post(f"{route}/stop").status_code == 200
    client.put(f"{route}/surroundings", json={pressed: False})
    assert "Acknowledge" in error_of(client.post(f"{route}/move", json={"by_steps": 5}), 409)["message"]
    acknowledged = client.post(f"{route}/acknowledge").json()
    assert (acknowledged["stopped_by"], acknowledged["message"]) == ([], None)
    assert client.post(f"{route}/move", json={"by_steps": 5}).status_code == 200


def test_a_limit_switch_is_named(client: TestClient, route: str) -> None:
    client.post(f"{route}/move", json={"by_steps": -900})
    until(lambda: client.get(route).json()["state"] == "ready")
    assert -320 < axis_of(client, route)["position_steps"] <= -200
    message = error_of(client.post(f"{route}/move", json={"by_steps": -1}), 409)["message"]
    assert message == (
        "Axis 0 is on the limit switch of its low end at A2 and goes no further that way: move it the other way."
    )
    assert client.post(f"{route}/move", json={"by_steps": 1}).status_code == 200


@pytest.mark.parametrize(
    ("body", "field"),
    [
        ({}, "axes"),
        ({**HOME, "axes": []}, "axes"),
        ({**HOME, "axes": [{"axis": 0, "fast_steps_per_s": 0}]}, "axes.0.fast_steps_per_s"),
        ({**HOME, "axes": [{"axis": 0, "fast_steps_per_s": 400}]}, "axes.0.fast_steps_per_s"),
        ({**HOME, "axes": [{"axis": 0, "fast_steps_per_s": -1001}]}, "axes.0.fast_steps_per_s"),
        ({**HOME, "axes": [{"axis": 2, "fast_steps_per_s": -400}]}, "axes.0.axis"),
        ({**HOME, "axes": HOME["axes"] * 2}, "axes.1.axis"),
        ({**HOME, "slow_steps_per_s": 0}, "slow_steps_per_s"),
        ({**HOME, "slow_steps_per_s": 1001}, "slow_steps_per_s"),
        ({**HOME, "back_off_steps": 0}, "back_off_steps"),
        ({**HOME, "back_off_steps": 65_536}, "back_off_steps"),
        ({**HOME, "for_s": 0}, "for_s"),
    ],
)
def test_homings_that_cant_be(client: TestClient, route: str, body: Any, field: str) -> None:
    errors = client.post(f"{route}/home", json=body).json()["errors"]
    assert field in [each["field"] for each in errors]


@pytest.mark.parametrize(
    ("body", "field"),
    [
        ({"emergency_stop": 1}, "emergency_stop"),
        ({"axes": [{"axis": 0, "low_steps": 5, "high_steps": 5}]}, "axes.0.high_steps"),
        ({"axes": [{"axis": 4}]}, "axes.0.axis"),
        ({"axes": []}, "axes"),
        ({"axes": [{"axis": 1, "low_steps": 1}, {"axis": 1, "low_steps": 2}]}, "axes.1.axis"),
    ],
)
def test_surroundings_that_cant_be(client: TestClient, route: str, body: Any, field: str) -> None:
    assert error_of(client.put(f"{route}/surroundings", json=body), 422)["field"] == field


def test_what_is_null_of_surroundings_stays_and_of_a_named_axis_goes(client: TestClient, route: str) -> None:
    def put(body: dict[str, Any]) -> dict[str, Any]:
        answer: dict[str, Any] = client.put(f"{route}/surroundings", json=body).json()
        return answer

    put({"driver_fault": True, "axes": [{"axis": 1, "low_steps": -7, "high_steps": 7}]})
    left = put({"emergency_stop": None, "driver_fault": None, "axes": None})
    assert (left["driver_fault"], left["axes"][1]["low_steps"], left["axes"][1]["high_steps"]) == (True, -7, 7)
    anew = put({"axes": [{"axis": 1, "high_steps": 9}]})
    assert (anew["axes"][1]["low_steps"], anew["axes"][1]["high_steps"]) == (None, 9)
    assert anew["axes"][0]["low_steps"] == left["axes"][0]["low_steps"]


def test_a_homing_of_no_axis_says_what_it_wants(client: TestClient, route: str) -> None:
    error = error_of(client.post(f"{route}/home", json={**HOME, "axes": []}), 422)
    assert error["message"].endswith("a list of 1 to 4 axes, each with how it finds its switch.")


def test_no_input_becomes_an_emergency_stop_that_is_pressed(client: TestClient, route: str) -> None:
    """By a wrong level nobody could release it."""
    limits = ROLES[1:]
    assert client.put(f"{route}/settings", json={"inputs": limits}).status_code == 200
    client.put(f"{route}/surroundings", json={"emergency_stop": True})
    error = error_of(client.put(f"{route}/settings", json={"inputs": ROLES}), 422)
    assert (error["field"], error["value"]) == ("inputs.0.active", "high")
    assert error["allowed"].startswith("low, unless the emergency stop is pressed: A0 is high now")
    device = client.get(route).json()
    assert (device["stopped_by"], [each["input"] for each in device["inputs"]]) == ([], ["A1", "A2", "D9"])
    client.put(f"{route}/surroundings", json={"emergency_stop": False})
    assert client.put(f"{route}/settings", json={"inputs": ROLES}).status_code == 200


def test_nothing_is_stored_in_an_emergency(client: TestClient, route: str) -> None:
    client.put(f"{route}/surroundings", json={"emergency_stop": True})
    message = error_of(client.post(f"{route}/keep"), 409)["message"]
    assert "the emergency stop at A0 is active" in message
    assert "Until then nothing is stored" in message
    client.put(f"{route}/surroundings", json={"emergency_stop": False})
    assert client.post(f"{route}/acknowledge").status_code == 200
    assert client.post(f"{route}/keep").status_code == 200


def test_what_a_refusal_knows_is_shown_at_once_and_names_the_cause(client: TestClient, route: str) -> None:
    client.put(f"{route}/surroundings", json={"emergency_stop": True})
    error_of(client.post(f"{route}/move", json={"by_steps": 3}), 409)
    assert client.get(route).json()["stopped_by"] == ["emergency_stop"]
    client.put(f"{route}/surroundings", json={"emergency_stop": False})
    message = error_of(client.post(f"{route}/move", json={"by_steps": 3}), 409)["message"]
    assert message == "Nothing moves: the emergency stop has stopped all axes. Acknowledge that first."


def test_a_refusal_names_the_axis_that_is_at_fault(client: TestClient, route: str) -> None:
    client.put(f"{route}/surroundings", json={"axes": [{"axis": 0, "low_steps": 0, "high_steps": None}]})
    error = error_of(client.post(f"{route}/move", json={"by_steps": -3}), 409)
    assert (error["field"], error["value"], error["allowed"]) == ("axis", 0, "away from its low end")
    client.put(f"{route}/surroundings", json={"axes": [{"axis": 0, "low_steps": None, "high_steps": None}]})
    assert (
        client.post(f"{route}/run", json={"axes": [{"axis": 1, "speed_steps_per_s": 800}], "for_s": 5}).status_code
        == 200
    )
    error = error_of(client.put(f"{route}/settings", json={"looks": 3}), 409)
    assert (error["field"], error["value"], error["allowed"]) == ("axis", 1, "at rest")
    assert error["message"] == "The motor moves, that of axis 1: stop it first."
