"""Who is in control of a device, jogs that live on a lease, previews, and there and back."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable
from typing import Any

import pytest
from starlette.testclient import TestClient

from designs import document
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.link import protocol_sim

DEVICES = "/api/v1/devices"
LOCAL = {"host": "127.0.0.1:8000"}
PATIENCE_S = 15.0
PAGE = "X-StepRamp-Page"
_numbers = itertools.count()


def until(condition: Callable[[], Any]) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.01)


@pytest.fixture
def route(client: TestClient) -> str:
    """Return the route of a device with two axes that have a ramp."""
    port = f"sim://control-{next(_numbers)}"
    protocol_sim.register(port, VirtualController())
    connected = client.post(DEVICES, json={"port": port}).json()
    route = f"{DEVICES}/{connected['id']}"
    assert client.post(f"{route}/push", json={"axes": [document(), document()]}).status_code == 200
    return route


def listening(client: TestClient, page: str) -> Any:
    return client.websocket_connect(f"{DEVICES}/events?page={page}", headers=LOCAL)


def test_the_first_page_that_acts_is_in_control_until_it_is_gone(client: TestClient, route: str) -> None:
    assert client.get(route).json()["in_control"] is None
    with listening(client, "one") as one, listening(client, "two") as two:
        one.receive_json(), two.receive_json()
        moved = client.post(f"{route}/move", json={"by_steps": 10}, headers={PAGE: "one"})
        assert moved.json()["in_control"] == "one"
        other = {PAGE: "two"}
        for method, what, body in [
            ("POST", "/move", {"by_steps": 10}),
            ("POST", "/push", {"design": document()}),
            ("POST", "/run", {"speed_steps_per_s": 100}),
            ("PUT", "/settings", {}),
            ("POST", "/home", {"axes": [{"axis": 0, "fast_steps_per_s": -100}], "slow_steps_per_s": 50}),
            ("POST", "/acknowledge", None),
            ("PUT", "/surroundings", {}),
            ("POST", "/keep", None),
            ("DELETE", "", None),
        ]:
            refused = client.request(method, route + what, json=body, headers=other)
            assert refused.status_code == 409, what
            assert "Another page is in control" in refused.json()["errors"][0]["message"]
        assert client.post(f"{route}/stop", headers=other).status_code == 200
        assert client.post(f"{route}/halt", headers=other).status_code == 200
        assert client.post(f"{DEVICES}/stop", headers=other).status_code == 200
        assert client.post(f"{route}/move", json={"by_steps": 1}).status_code == 200, "a program is not hindered"
        assert client.post(f"{route}/control", headers=other).json()["in_control"] == "two"
        assert client.post(f"{route}/move", json={"by_steps": 1}, headers={PAGE: "one"}).status_code == 409
    until(lambda: client.get(route).json()["in_control"] is None)


def test_who_cant_be_in_control(client: TestClient, route: str) -> None:
    assert client.post(f"{route}/control").status_code == 409
    assert client.post(f"{route}/control", headers={PAGE: "deaf"}).status_code == 409
    moved = client.post(f"{route}/move", json={"by_steps": 10}, headers={PAGE: "deaf"})
    assert (moved.status_code, moved.json()["in_control"]) == (200, None)


def test_connecting_what_another_page_controls_shows_it_and_leaves_it(client: TestClient, route: str) -> None:
    with listening(client, "one") as one, listening(client, "two") as two:
        one.receive_json(), two.receive_json()
        port = client.get(route).json()["port"]
        assert client.post(DEVICES, json={"port": port}, headers={PAGE: "one"}).json()["in_control"] == "one"
        assert client.post(DEVICES, json={"port": port}, headers={PAGE: "two"}).json()["in_control"] == "one"


def jogging(client: TestClient, route: str) -> Any:
    return client.websocket_connect(f"{route}/jog", headers=LOCAL)


def run(socket: Any, client: TestClient, route: str, **changes: int) -> None:
    """Jog until the device is seen to move: a busy machine may let a jog run out before."""
    wanted = {"do": "run", "speed_steps_per_s": 400} | changes

    def is_seen_to_move() -> bool:
        socket.send_json(wanted)
        time.sleep(0.05)
        return bool(client.get(route).json()["state"] == "moving")

    until(is_seen_to_move)


def test_a_jog_runs_while_it_is_held_and_ends_by_itself_when_it_isnt(client: TestClient, route: str) -> None:
    with jogging(client, route) as socket:
        run(socket, client, route, axis=1, speed_steps_per_s=-400)
        began = time.monotonic()
        while time.monotonic() - began < 1.0:
            socket.send_json({"do": "hold"})
            time.sleep(0.05)
        assert client.get(route).json()["axes"][1]["state"] == "moving"
        # The socket stays open, and nothing more is said over it.
        until(lambda: client.get(route).json()["state"] == "ready")
        socket.send_json({"do": "hold"})
        time.sleep(0.2)
        assert client.get(route).json()["state"] == "ready", "what ran out is not brought back"
    axes = client.get(route).json()["axes"]
    assert (axes[0]["position_steps"], axes[1]["position_steps"] < -200) == (0, True)


def test_who_holds_a_jog_that_ran_out_is_told(client: TestClient, route: str) -> None:
    with jogging(client, route) as socket:
        run(socket, client, route)
        until(lambda: client.get(route).json()["state"] == "ready")
        socket.send_json({"do": "hold"})
        told = [error["message"] for error in socket.receive_json()["errors"]]
        # By a busy machine; then it was asked again.
        while "It was let go, or not told to go on in time, before it began." in told:
            told = [error["message"] for error in socket.receive_json()["errors"]]
        assert told == ["The jog ended: it was not told to go on for 0.4 s, and the axis slowed down. Begin it again."]
        # It is told once, and not of a jog that was let go.
        socket.send_json({"do": "hold"})
        socket.send_json({"do": "end"})
        socket.send_json({"do": "hold"})
        socket.send_json({"do": "fly"})
        assert socket.receive_json()["errors"][0]["field"] == "do"


@pytest.mark.parametrize("way", ["end", "close", "wrong"])
def test_a_jog_is_let_go(client: TestClient, route: str, way: str) -> None:
    with jogging(client, route) as socket:
        run(socket, client, route)
        if way == "end":
            socket.send_json({"do": "end"})
        elif way == "wrong":
            socket.send_text("what?")
            assert "a JSON object" in socket.receive_json()["errors"][0]["message"]
        else:
            socket.close()
        until(lambda: client.get(route).json()["state"] in ("stopping", "ready"))
        until(lambda: client.get(route).json()["state"] == "ready")


def test_a_stop_ends_a_jog_that_is_still_held(client: TestClient, route: str) -> None:
    with jogging(client, route) as socket:
        run(socket, client, route)
        client.post(f"{DEVICES}/stop")

        def at_rest() -> bool:
            socket.send_json({"do": "hold"})
            return bool(client.get(route).json()["state"] == "ready")

        until(at_rest)
        socket.send_json({"do": "hold"})
        time.sleep(0.1)
        assert client.get(route).json()["state"] == "ready"


@pytest.mark.parametrize(
    ("message", "field"),
    [
        ({"do": "run", "speed_steps_per_s": 5_000}, "speed_steps_per_s"),
        ({"do": "run", "axis": 3, "speed_steps_per_s": 100}, "axis"),
        ({"do": "run"}, "speed_steps_per_s"),
        ({"do": "run", "speed_steps_per_s": None}, "speed_steps_per_s"),
        ({"do": "fly"}, "do"),
        ({"do": "hold", "for": 3}, "for"),
        ([], None),
    ],
)
def test_jogs_that_cant_be(client: TestClient, route: str, message: Any, field: str | None) -> None:
    with jogging(client, route) as socket:
        socket.send_json(message)
        [error] = socket.receive_json()["errors"]
        assert error["message"]
        if field is not None:
            assert error["field"] == field
    assert client.get(route).json()["state"] == "ready"


def test_taking_over_ends_the_jog_of_the_other_page(client: TestClient, route: str) -> None:
    with listening(client, "one") as one, listening(client, "two") as two:
        one.receive_json(), two.receive_json()
        with client.websocket_connect(f"{route}/jog?page=one", headers=LOCAL) as socket:
            run(socket, client, route)
            with client.websocket_connect(f"{route}/jog?page=two", headers=LOCAL) as refused:
                assert "Another page" in refused.receive_json()["errors"][0]["message"]
            assert client.post(f"{route}/control", headers={PAGE: "two"}).status_code == 200
            socket.send_json({"do": "hold"})
            [error] = socket.receive_json()["errors"]
            assert error["message"] == (
                "The jog ended: its page is no longer in control of the device, and the axis slowed down."
            )

            def at_rest() -> bool:
                socket.send_json({"do": "hold"})
                return bool(client.get(route).json()["state"] == "ready")

            until(at_rest)
            # It is told once.
            socket.send_json({"do": "fly"})
            assert [each["field"] for each in socket.receive_json()["errors"]] == ["do"]


def test_what_a_push_would_change(client: TestClient, route: str) -> None:
    before = client.get(route).json()
    same = client.post(f"{route}/push/preview", json={"design": document()}).json()
    assert (same["same"], [item["name"] for item in same["items"] if item["differs"]]) == (True, [])
    slower = document(ramp__slew_speed_steps_per_s=500)
    preview = client.post(f"{route}/push/preview", json={"design": slower, "to_axis": 1}).json()
    assert not preview["same"]
    # 1,000 steps/s with 5,000 steps/s²: 100 steps; 500: 25. Intervals of 1,000 and 2,000 µs.
    differing = {item["name"]: (item["on_device"], item["to_send"]) for item in preview["items"] if item["differs"]}
    crc = differing.pop("Ramp image")
    assert crc[0] == before["ramp"]["crc"]
    assert differing == {
        "Up ramp steps": (100, 25),
        "Slew interval": (1000.0, 2000.0),
        "Down ramp steps": (100, 25),
    }
    assert {item["axis"] for item in preview["items"]} == {1, None}
    assert client.get(route).json()["ramp"] == before["ramp"], "nothing was sent"
    pushed = client.post(f"{route}/push", json={"design": slower, "to_axis": 1}).json()
    assert [item["sent"] for item in pushed["items"] if item["name"] == "Ramp image"] == [crc[1]]


def test_a_preview_for_a_controller_without_ramps_and_with_fewer_axes(client: TestClient, route: str) -> None:
    fewer = client.post(f"{route}/push/preview", json={"axes": [document()]}).json()
    gone = [(item["on_device"] is not None, item["to_send"]) for item in fewer["items"] if item["axis"] == 1]
    assert gone
    assert set(gone) == {(True, None)}
    port = f"sim://control-{next(_numbers)}"
    protocol_sim.register(port, VirtualController())
    empty = f"{DEVICES}/{client.post(DEVICES, json={'port': port}).json()['id']}"
    first = client.post(f"{empty}/push/preview", json={"design": document()}).json()
    assert [item["on_device"] for item in first["items"]][1:] == [None] * (len(first["items"]) - 1)
    too_fast = document(ramp__slew_speed_steps_per_s=160_000)
    refused = client.post(f"{empty}/push/preview", json={"design": too_fast})
    assert refused.status_code == 422
    assert refused.json()["errors"][0]["field"] == "design.ramp.slew_speed_steps_per_s"


def test_the_socket_tells_how_far_a_push_has_come(client: TestClient, route: str) -> None:
    heard: list[tuple[str, int, int]] = []
    with listening(client, "one") as socket:
        first = socket.receive_json()["devices"][0]
        assert first["progress"] is None
        design = document(ramp__acceleration_steps_per_s2=2000)
        assert client.post(f"{route}/push", json={"design": design}).status_code == 200
        while True:
            progress = socket.receive_json()["devices"][0]["progress"]
            if progress is None and not heard:
                continue  # What had changed before it began.
            if progress is None:
                break
            heard.append((progress["stage"], progress["bytes_done"], progress["bytes_total"]))
    order = ["planning", "sending", "checking", "storing", "reading_back"]
    stages = [stage for stage, _, _ in heard]
    assert stages == sorted(stages, key=order.index)
    assert "storing" in stages
    assert all(done <= total for _, done, total in heard)


def test_there_and_back(client: TestClient, route: str) -> None:
    begun = client.post(f"{route}/there_and_back", json={"axis": 1, "by_steps": 40, "times": 2, "pause_s": 0.05})
    shuttle = begun.json()["shuttle"]
    assert shuttle == {"axis": 1, "by_steps": 40, "times": 2, "times_done": 0, "pause_s": 0.05}
    targets = set()

    def over() -> bool:
        device = client.get(route).json()
        targets.add(device["axes"][1]["target_steps"])
        return device["shuttle"] is None

    until(over)
    assert targets == {0, 40}
    axis = client.get(route).json()["axes"][1]
    assert (axis["state"], axis["position_steps"]) == ("ready", 0)


@pytest.mark.parametrize("what", ["stop", "halt", "move", "all"])
def test_what_ends_there_and_back_in_a_pause(client: TestClient, route: str, what: str) -> None:
    client.post(f"{route}/there_and_back", json={"by_steps": 20, "times": 9, "pause_s": 1.5})
    until(lambda: client.get(route).json()["state"] == "ready")
    assert client.get(route).json()["shuttle"] is not None
    if what == "all":
        client.post(f"{DEVICES}/stop")
    else:
        client.post(f"{route}/{what}", json={"by_steps": 1} if what == "move" else None)
    assert client.get(route).json()["shuttle"] is None
    time.sleep(1.7)
    assert client.get(route).json()["position_steps"] == (21 if what == "move" else 20)


@pytest.mark.parametrize(
    ("body", "field"),
    [
        ({"by_steps": 0}, "by_steps"),
        ({}, "by_steps"),
        ({"by_steps": 1, "times": 0}, "times"),
        ({"by_steps": 1, "pause_s": -1}, "pause_s"),
        ({"by_steps": 1, "axis": 3}, "axis"),
    ],
)
def test_there_and_back_that_cant_be(client: TestClient, route: str, body: dict[str, Any], field: str) -> None:
    refused = client.post(f"{route}/there_and_back", json=body)
    assert refused.status_code == 422
    assert refused.json()["errors"][0]["field"] == field
    assert client.get(route).json()["shuttle"] is None
