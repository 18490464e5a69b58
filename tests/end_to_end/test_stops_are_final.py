"""A thousand stops at random moments around what sets motors moving, over HTTP, against the real firmware."""

from __future__ import annotations

import http.client
import json
import random
import socket
import struct
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from websockets.sync.client import connect

from designs import document
from server_process import ServerProcess, answer_over
from simulator.avr import SimulatedController, build_firmware, missing_tools
from tools import require

STOPS = 1000
FAR = 9_000_000
EARLIEST_S, LATEST_S = -0.014, 0.016
"""From when a motion is asked for until it is stopped: from before it reaches the server until it moves."""
AT_REST_WITHIN_S = 5.0
SO_TIMESTAMPNS = 35
"""Linux: the system notes when what is received arrived, which for this machine's own is when it was written."""
QUIET_S = 0.02
"""A move that was still on its way would have set out in this time."""

MOTIONS: list[tuple[str, dict[str, Any]]] = [
    ("move", {"by_steps": FAR}),
    ("move", {"axes": [{"axis": 1, "by_steps": -FAR}]}),
    ("run", {"axes": [{"axis": 0, "speed_steps_per_s": 1500}, {"axis": 1, "speed_steps_per_s": -900}], "for_s": 600}),
    ("line", {"axes": [{"axis": 0, "by_steps": FAR}, {"axis": 1, "by_steps": -FAR // 3}]}),
    ("there_and_back", {"by_steps": 3, "times": 5000}),
    ("jog", {"do": "run", "axis": 1, "speed_steps_per_s": 1200}),
    ("home", {"axes": [{"axis": 0, "fast_steps_per_s": -1500}], "slow_steps_per_s": 500}),
    ("home", {"axes": [{"axis": 2, "fast_steps_per_s": -1500}], "slow_steps_per_s": 1500, "back_off_steps": 3}),
]
LIMITS = [
    {"input": "A0", "role": "limit", "axis": 0, "end": "low"},
    {"input": "D9", "role": "limit", "axis": 2, "end": "low"},
]
SWITCH = "9:2<0"
"""Axis 2 rests at its switch, where homing has left it, and so goes through all of it again. Axis 0 never finds its."""


@pytest.fixture
def server() -> Iterator[ServerProcess]:
    with ServerProcess(8750) as server:
        yield server


@pytest.fixture
def controller(tmp_path: Path) -> Iterator[SimulatedController]:
    require(*missing_tools())
    firmware = build_firmware("INPUTS=yes")
    with SimulatedController(firmware, tmp_path, surroundings=["--switch", SWITCH]) as controller:
        yield controller


@dataclass
class Trial:
    """One motion and the stop around it, by the system's clock [s]."""

    asked_s: float
    """When the last byte of the motion's request had left."""
    answered_s: float
    """When the server wrote the stop's answer."""
    granted: bool

    @property
    def asked_before(self) -> bool:
        """Whether the motion was asked for before the stop was answered: then it must not move."""
        return self.asked_s < self.answered_s


class Rig:
    """A device, a connection for motions and one for stops."""

    def __init__(self, server: ServerProcess, device: str) -> None:
        self.device = device
        self._motions, self._stops, self._looks = (server.connection() for _ in range(3))
        self._stops.connect()
        self._stops.sock.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMPNS, 1)
        self._socket_address = f"ws://{server.address.netloc}/api/v1/devices/{device}/jog"

    def move(self, what: str, body: dict[str, Any], asked: Future[float]) -> bool:
        """Ask for a motion, note when that had left, and return whether it was granted."""
        if what == "jog":
            return self._jog(body, asked)
        send(self._motions, f"devices/{self.device}/{what}", body)
        asked.set_result(time.time())
        with self._motions.getresponse() as response:
            response.read()
            return response.status == 200

    def _jog(self, body: dict[str, Any], asked: Future[float]) -> bool:
        """Jog as a page does, whose finger presses on for a while."""
        with connect(self._socket_address) as socket:
            socket.send(json.dumps(body))
            asked.set_result(time.time())
            for _ in range(3):
                time.sleep(0.005)
                socket.send('{"do": "hold"}')
        return True

    def stop(self, what: str) -> float:
        """Stop, see that it is answered, and return when the answer was written."""
        route = "devices/stop" if what == "all" else f"devices/{self.device}/{what}"
        self._stops.request("POST", f"/api/v1/{route}")
        written_s = written_at(self._stops.sock)
        with self._stops.getresponse() as response:
            content = response.read()
            assert response.status == 200, content
        return written_s

    def trace(self) -> None:
        """Have the next move traced, so that more is asked of the controller before it begins."""
        assert answer_over(self._looks, "PUT", f"devices/{self.device}/trace", {"traced_axis": 0})[0] == 200

    def look(self) -> dict[str, Any]:
        return dict(answer_over(self._looks, "GET", f"devices/{self.device}")[1])

    def close(self) -> None:
        for connection in (self._motions, self._stops, self._looks):
            connection.close()


def send(connection: http.client.HTTPConnection, route: str, body: dict[str, Any]) -> None:
    connection.request("POST", f"/api/v1/{route}", json.dumps(body), {"content-type": "application/json"})


def written_at(connection: socket.socket) -> float:
    """Wait for an answer, leave it to be read, and return when it was written."""
    _, notes, _, _ = connection.recvmsg(1, 256, socket.MSG_PEEK)
    seconds, nanoseconds = next(struct.unpack("qq", note) for _, kind, note in notes if kind == SO_TIMESTAMPNS)
    return float(seconds + nanoseconds * 1e-9)


def tried(rig: Rig, pool: ThreadPoolExecutor, chance: random.Random) -> Trial:
    """Ask for a motion and for a stop, at a random moment around it."""
    what, body = chance.choice(MOTIONS)
    stop, offset_s = chance.choice(["stop", "halt", "all"]), chance.uniform(EARLIEST_S, LATEST_S)
    if chance.random() < 0.3:
        rig.trace()
    begin_s = time.perf_counter() + 0.006
    asked: Future[float] = Future()

    def move() -> bool:
        wait_until(begin_s)
        return rig.move(what, body, asked)

    moving = pool.submit(move)
    wait_until(begin_s + offset_s)
    answered_s = rig.stop(stop)
    trial = Trial(asked.result(), answered_s, granted=moving.result())
    if not trial.asked_before:
        rig.stop("halt")
    try:
        see_that_it_stays(rig)
    except AssertionError as error:
        error.add_note(f"{what} {body}, {stop} after {offset_s * 1000:.1f} ms: {trial}")
        raise
    return trial


def wait_until(moment_s: float) -> None:
    while (left_s := moment_s - time.perf_counter()) > 0:
        time.sleep(left_s / 2)


def see_that_it_stays(rig: Rig) -> None:
    """The motor comes to rest and makes no further step."""
    deadline = time.monotonic() + AT_REST_WITHIN_S
    while (device := rig.look())["state"] != "ready":
        assert time.monotonic() < deadline, f"still {device['state']} after a stop: {device['axes']}"
        time.sleep(0.004)
    places = [axis["position_steps"] for axis in device["axes"]]
    time.sleep(QUIET_S)
    later = rig.look()
    assert (later["state"], later["shuttle"]) == ("ready", None)
    assert [(axis["position_steps"], axis["homing"]) for axis in later["axes"]] == [(place, False) for place in places]


def test_a_thousand_stops_hold(
    server: ServerProcess, controller: SimulatedController, record_property: Callable[[str, object], None]
) -> None:
    device = server.ask("POST", "devices", {"port": controller.port})["id"]
    quick = document(ramp__slew_speed_steps_per_s=2000, ramp__acceleration_steps_per_s2=60_000)
    server.ask("POST", f"devices/{device}/push", {"axes": [quick] * 3, "mode": "try"})
    server.ask("PUT", f"devices/{device}/settings", {"inputs": LIMITS})
    chance = random.Random(11)
    with closing(Rig(server, device)) as rig, ThreadPoolExecutor(1) as pool:
        trials = [tried(rig, pool, chance) for _ in range(STOPS)]
    overtaken = [trial for trial in trials if trial.asked_before]
    record_property("stops_that_held", len(trials))
    record_property("asked_before_the_answer", len(overtaken))
    print(
        f"\n{len(trials)} stops held; {len(overtaken)} motions were asked for before the answer, "
        f"{sum(trial.granted for trial in overtaken)} of them had set out"
    )
    # The moments are spread as they should be: many were asked for before the answer, and some of them had set out.
    assert len(overtaken) > 0.5 * STOPS
    assert 0.02 * STOPS < sum(trial.granted for trial in overtaken) < len(overtaken)
