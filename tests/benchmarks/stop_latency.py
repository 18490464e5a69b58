"""Measure how long a STOP over HTTP takes, at rest and while the server has more to do than it can.

usage: PYTHONPATH=tests python tests/benchmarks/stop_latency.py

The server and what keeps it busy are processes of their own; a motor runs before each stop. `answer` is the time from
sending the request to the end of the answer. `last step` is the time from sending a halt until the simulator's file of
edges has the last one. The edges carry cycles, which can't be told in times of day: a simulator on a busy machine lags
by up to 0.1 s. So it is the file that is watched, every ms. It is written every 10 ms, hence the last step was made up
to 11 ms before that; it is never later.

`machine` is how late a process wakes that only sleeps: what the machine itself adds, each of the several times that a
stop wakes somebody.
"""

import http.client
import json
import os
import socket
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from browser.server import Server
from designs import document
from firmware.rig import controller_in
from simulator.avr import build_firmware, build_harness, missing_tools

SPEED_STEPS_PER_S = 2000
RAMP_S = 0.05
LOAD = Path(__file__).with_name("stop_load.py")
IDLE_STOPS, BUSY_S = 40, 12.0
AT_REST_S = 0.3
SETTLED_S = 4.0
"""So long a server compiles its numerics after its start, or loads them."""
PATIENCE_S = 60.0
SLEEPER = """
import json, select, sys, time
late_ms = []
while not select.select([sys.stdin], [], [], 0)[0]:
    began = time.monotonic()
    time.sleep(0.002)
    late_ms.append((time.monotonic() - began - 0.002) * 1000)
print(json.dumps(late_ms))
"""


class Api:
    """One connection to the server, kept open as long as the server does."""

    def __init__(self, port: int) -> None:
        self._connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)
        self._connect()

    def _connect(self) -> None:
        self._connection.close()
        self._connection.connect()
        self._connection.sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def ask(self, method: str, path: str, body: dict[str, Any] | None = None) -> dict[str, Any]:
        """Return the answer to a request; RuntimeError when it is refused."""
        text = None if body is None else json.dumps(body)
        headers = {} if text is None else {"content-type": "application/json"}
        try:
            self._connection.request(method, f"/api/v1{path}", text, headers)
            response = self._connection.getresponse()
        except ConnectionError:
            # With too many of them open the server ends those that wait for a request.
            self._connect()
            self._connection.request(method, f"/api/v1{path}", text, headers)
            response = self._connection.getresponse()
        answer: dict[str, Any] = json.loads(response.read())
        if response.status != 200:
            raise RuntimeError(f"{method} {path}: {answer}")
        return answer


@dataclass(frozen=True)
class Motor:
    """A device with a ramp, and the file of its edges, if it is a simulated chip."""

    api: Api
    route: str
    edges: Path | None = None

    def run(self) -> None:
        """Have it run, and wait until it does so at full speed."""
        self.api.ask("POST", f"{self.route}/run", {"speed_steps_per_s": SPEED_STEPS_PER_S, "for_s": PATIENCE_S})
        time.sleep(2 * RAMP_S)

    def answered_ms(self, how: str) -> float:
        """Return how long a stop or a halt takes to be answered [ms]."""
        began = time.monotonic()
        self.api.ask("POST", f"{self.route}/{how}")
        return (time.monotonic() - began) * 1000

    def stopped_ms(self) -> Iterator[tuple[str, float]]:
        """Yield how long a stop and a halt of a motor that runs take [ms]."""
        self.run()
        yield "stop, answer", self.answered_ms("stop")
        self.run()
        with ThreadPoolExecutor(1) as pool:
            began = time.monotonic()
            at_rest_s = pool.submit(self._at_rest_s)
            yield "halt, answer", self.answered_ms("halt")
        if self.edges is not None:
            yield "halt, last step", (at_rest_s.result() - began) * 1000

    def _at_rest_s(self) -> float:
        """Watch the file of edges until it grows no more; return when it did so last, by the monotonic clock [s]."""
        size, grown_s = -1, time.monotonic()
        while self.edges is not None and time.monotonic() < grown_s + AT_REST_S:
            if (now := self.edges.stat().st_size) != size:
                size, grown_s = now, time.monotonic()
            time.sleep(0.001)
        return grown_s


def connected(api: Api, port: str, edges: Path | None = None) -> Motor:
    """Return a controller's motor, with a ramp."""
    route = f"/devices/{api.ask('POST', '/devices', {'port': port})['id']}"
    acceleration = SPEED_STEPS_PER_S / RAMP_S
    design = document(ramp__slew_speed_steps_per_s=SPEED_STEPS_PER_S, ramp__acceleration_steps_per_s2=acceleration)
    api.ask("POST", f"{route}/push", {"design": design, "mode": "try"})
    return Motor(api, route, edges)


@contextmanager
def busy(port: int) -> Iterator[Callable[[], bool]]:
    """Keep the server busy; yield whether that still goes on. It ends by itself."""
    # Clients are elsewhere: they must not take the time of the server and of the chip.
    command = ["nice", "-n", "10", sys.executable, str(LOAD), str(port), str(BUSY_S)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    ends_at = time.monotonic() + BUSY_S
    try:
        yield lambda: time.monotonic() < ends_at
    finally:
        process.terminate()
        process.communicate()


def row(words: str, times_ms: list[float]) -> str:
    """Return a line of the table."""
    cells = (min(times_ms), statistics.median(times_ms), *np.percentile(times_ms, (95, 99)), max(times_ms))
    return f"| {words} | {len(times_ms)} | " + " | ".join(f"{cell:.1f}" for cell in cells) + " |"


def measure(words: str, motor: Motor, goes_on: Callable[[int], bool]) -> None:
    """Print how long stops take as long as something goes on, told how many there were."""
    times_ms: dict[str, list[float]] = {}
    stops = 0
    while goes_on(stops):
        try:
            for what, spent_ms in motor.stopped_ms():
                times_ms.setdefault(what, []).append(spent_ms)
        except RuntimeError as error:
            # A simulated chip that gets too little of a busy machine doesn't read its port any more.
            print(f"| {words} | ended early: {error} |")
            break
        stops += 1
    for what, spent in times_ms.items():
        print(row(f"{words} | {what}", spent), flush=True)


@contextmanager
def lateness(words: str) -> Iterator[None]:
    """Measure meanwhile how late another process wakes, and print it."""
    process = subprocess.Popen(
        [sys.executable, "-c", SLEEPER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    try:
        yield
    finally:
        written, _ = process.communicate()
    print(row(f"{words} | machine", json.loads(written)), flush=True)


def measure_all(name: str, port: str, edges: Path | None = None) -> None:
    """Print the times of one controller, in a server of its own."""
    with Server() as server:
        api = Api(server.port)
        motor = connected(api, port, edges)
        time.sleep(SETTLED_S)
        with lateness(f"{name} | idle"):
            measure(f"{name} | idle", motor, lambda stops: stops < IDLE_STOPS)
        with busy(server.port) as still_busy, lateness(f"{name} | busy"):
            measure(f"{name} | busy", motor, lambda _: still_busy())


def stop_latency() -> None:
    """Print how long stops take, with the virtual controller and with the real firmware."""
    print(f"Load of the machine at the beginning: {os.getloadavg()[0]:.1f}")
    print("\n| controller | server | what | stops | least ms | median | 95 % | 99 % | largest |")
    print("|---|---|---|---:|---:|---:|---:|---:|---:|")
    measure_all("virtual", "sim://")
    if missing := missing_tools():
        print(f"\nThe firmware is left out: {', '.join(missing)} missing.")
        return
    build_firmware()
    build_harness()
    with tempfile.TemporaryDirectory() as folder, controller_in(Path(folder) / "chip") as simulated:
        measure_all("firmware", simulated.port, Path(folder) / "chip" / "edges.bin")


if __name__ == "__main__":
    stop_latency()
