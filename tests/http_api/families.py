"""What the tests of every family of controllers do over the API, and what holds for a device of each.

A family's own tests give `cable`, what its controller is plugged in with; `device`, the route of one that is connected
and has a ramp of 1000 steps/s and 5000 steps/s²; and `motor`, what that really does.
"""

from __future__ import annotations

import random
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import pytest
from starlette.testclient import TestClient

from controllers.pseudo_terminal import PseudoTerminal

DEVICES = "/api/v1/devices"
PATIENCE_S = 60.0
"""A machine that is busy is slow, not wrong."""


@dataclass(frozen=True)
class Motor:
    """The first axis of a controller, as it is there and not as it is told."""

    place: Callable[[], int]
    steps: Callable[[], int]
    """How many the controller has made, to and fro."""


def ok(response: Any) -> Any:
    assert response.status_code == 200, response.text
    return response.json()


def error_of(response: Any, status: int) -> dict[str, Any]:
    assert response.status_code == status, response.text
    [error] = response.json()["errors"]
    return error


def connected(client: TestClient, port: str, family: str) -> str:
    """Connect what is at a port, and return its route."""
    return f"{DEVICES}/{ok(client.post(DEVICES, json={'port': port, 'family': family}))['id']}"


def wait_until(client: TestClient, route: str, condition: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
    deadline = time.monotonic() + PATIENCE_S
    while not condition(device := client.get(route).json()):
        assert time.monotonic() < deadline, device
        time.sleep(0.02)
    return device


def at_rest(client: TestClient, route: str) -> dict[str, Any]:
    return wait_until(client, route, lambda device: device["state"] == "ready")


def stopped_around_motions(client: TestClient, device: str, path: str, body: dict[str, Any]) -> Iterator[None]:
    """Ask for a motion and for a stop at a random moment around it, and go on once it rests; time and again."""
    moments = random.Random(path)
    with ThreadPoolExecutor(1) as pool:
        for _ in range(20):
            # On a busy machine it may come in after the stop: then, too, it is one that was asked before.
            known = {"X-StepRamp-Stops": str(client.get(device).json()["stops"])}
            motion = pool.submit(client.post, f"{device}/{path}", json=body, headers=known)
            time.sleep(moments.uniform(0, 0.1))
            ok(client.post(f"{device}/stop"))
            assert motion.result().status_code in (200, 409), motion.result().text
            at_rest(client, device)
            yield


def stopped_amid_motions(client: TestClient, device: str, turns: int) -> Iterator[None]:
    """Have several ask for motions at the same time as one stops, and stop once all have; time and again."""

    def ask(number: int) -> None:
        body = {"to_steps": 4000 * (-1) ** number} if number % 3 else {"speed_steps_per_s": 400, "for_s": 5}
        client.post(f"{device}/{'move' if number % 3 else 'run'}", json=body)

    for turn in range(turns):
        with ThreadPoolExecutor(4) as asking:
            pending = [asking.submit(ask, turn + number) for number in range(4)]
            time.sleep(0.03 * turn)
            ok(client.post(f"{device}/stop"))
            for each in pending:
                each.result()
        ok(client.post(f"{device}/stop"))
        yield


class Laws:
    """What holds for a device of every family: a class of tests that takes these has them, too."""

    jogs_keep_their_speed: str | None = None
    """How another speed is refused where a controller has to rest before."""

    def test_running_lasts_as_long_as_its_lease(self, client: TestClient, device: str, motor: Motor) -> None:
        ok(client.post(f"{device}/run", json={"speed_steps_per_s": 500, "for_s": 1.5}))
        wait_until(client, device, lambda device: device["position_steps"] > 100)
        rested = at_rest(client, device)
        assert 300 < rested["position_steps"] == motor.place() < 1500
        assert rested["message"] is None

    def test_a_jog_gets_another_speed_on_its_way(
        self, client: TestClient, device: str, motor: Motor, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        # A machine that is busy may hold it late.
        monkeypatch.setattr("stepramp.http_api.jog.JOG_S", PATIENCE_S)
        with client.websocket_connect(f"{device}/jog", headers={"host": "127.0.0.1"}) as socket:
            for speed in (300, 600, 300):
                socket.send_json({"do": "run", "speed_steps_per_s": speed})
                for _ in range(6):
                    time.sleep(0.1)
                    socket.send_json({"do": "hold"})
                if refusal := self.jogs_keep_their_speed:
                    break
                assert client.get(device).json()["state"] == "moving", speed
            if refusal:
                socket.send_json({"do": "run", "speed_steps_per_s": 600})
                [error] = socket.receive_json()["errors"]
                assert error["message"] == refusal
        assert 100 < at_rest(client, device)["position_steps"] == motor.place()

    def test_there_and_back(self, client: TestClient, device: str, motor: Motor) -> None:
        ok(client.post(f"{device}/there_and_back", json={"by_steps": 60, "times": 2, "pause_s": 0}))
        wait_until(client, device, lambda device: device["shuttle"] is None and device["state"] == "ready")
        assert (motor.place(), motor.steps()) == (0, 240)

    def test_soft_limits_are_kept(self, client: TestClient, device: str, motor: Motor) -> None:
        limits = {"axes": [{"axis": 0, "lowest_steps": -100, "highest_steps": 1500}]}
        ok(client.put(f"{device}/soft_limits", json=limits))
        error_of(client.post(f"{device}/move", json={"by_steps": 1501}), 422)
        ok(client.post(f"{device}/run", json={"speed_steps_per_s": 990, "for_s": 30}))
        assert at_rest(client, device)["position_steps"] == motor.place() <= 1500

    def test_unplugging(self, client: TestClient, device: str, cable: PseudoTerminal) -> None:
        ok(client.post(f"{device}/run", json={"speed_steps_per_s": 500, "for_s": 30}))
        cable.unplug()
        lost = wait_until(client, device, lambda device: device["state"] == "lost")
        assert "Axis 0 was moving" in lost["message"]
        error_of(client.post(f"{device}/move", json={"by_steps": 5}), 502)
