"""Measure how long a small profile takes when 1, 50 and 200 clients compute at once, at rest and while a device moves.

usage: PYTHONPATH=tests python tests/benchmarks/client_load.py

The server and the clients are processes of their own. Each client keeps a connection and asks for its next profile as
soon as it has the last one; no client pauses. So the median is about the number of clients over the rate of answers,
which is as high as the machine and whatever else runs there allow: CPU times change less.

- `server`, `others`, `clients`: the CPU time for an answer of the server's process, of those that it has plan small
  profiles while many ask, and of the clients' [ms].
- `stop`: median and longest of the stops meanwhile, two a second [ms]; a device that moves is moved on after each.
- `told`: how old the newest status of the device was at most, to who listens to it meanwhile [ms]: at most some 1,500
  at rest, when it is asked every 500 and told of every 1,000. `missed`: how many were told in the wrong order, or older
  than the API promises.

Then four axes of 10,000,000 steps are planned together, three times at once, and the most memory is told that the
server ever had.

usage: python tests/benchmarks/client_load.py PORT CLIENTS SECONDS      (the clients: prints latencies [ms], as JSON)
"""

import asyncio
import http.client
import json
import resource
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import psutil
from websockets.sync.client import connect

from benchmarks.stop_load import long_ramp
from browser.server import Server
from designs import document

CLIENTS = (1, 50, 200)
MEASURED_S = 8.0
STOP_EVERY_S = 0.5
OLD_S = 1.0
"""Of a device that is well no status is told that is older, as `age_s` of the API promises [s]."""
END = b"\r\n\r\n"
AXES, STEPS, TOGETHER = 4, 10_000_000, 3


class Client(asyncio.Protocol):
    """Asks for one profile after the other over one connection, by as little as it can of the machine."""

    def __init__(self, request: bytes, until_s: float, latencies_ms: list[float], over: asyncio.Future[None]) -> None:
        self._request, self._until_s, self._latencies_ms, self._over = request, until_s, latencies_ms, over
        self._answer = b""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport
        self._ask()

    def data_received(self, data: bytes) -> None:
        self._answer += data
        head, end, body = self._answer.partition(END)
        if not end or len(body) < int(head.partition(b"content-length: ")[2].partition(b"\r\n")[0]):
            return
        self._latencies_ms.append((time.perf_counter() - self._began_s) * 1000)
        assert head.startswith(b"HTTP/1.1 200"), head
        if time.perf_counter() < self._until_s:
            self._ask()
        else:
            self._over.set_result(None)

    def connection_lost(self, exc: Exception | None) -> None:
        if not self._over.done():
            self._over.set_exception(exc or ConnectionError("The server has ended a connection."))

    def _ask(self) -> None:
        self._answer = b""
        self._began_s = time.perf_counter()
        self._transport.write(self._request)


async def ask_together(port: int, count: int, seconds: float) -> list[float]:
    """Have so many clients ask for so long; return how long each answer took [ms]."""
    body = json.dumps({"design": document(), "max_points": 200}).encode()
    head = f"POST /api/v1/profile HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Type: application/json\r\n"
    request = f"{head}Content-Length: {len(body)}".encode() + END + body
    latencies_ms: list[float] = []
    loop, until_s = asyncio.get_running_loop(), time.perf_counter() + seconds
    overs = [loop.create_future() for _ in range(count)]
    for over in overs:
        await loop.create_connection(lambda over=over: Client(request, until_s, latencies_ms, over), "127.0.0.1", port)
    await asyncio.gather(*overs)
    return latencies_ms


@dataclass
class Told:
    """What somebody has heard who listens to a device."""

    oldest_s: float = 0.0
    missed: int = 0
    _heard_s: float = 0.0
    _at_s: float = field(default_factory=time.monotonic)
    _age_s: float = 0.0

    def hear(self, device: dict[str, Any]) -> None:
        """Take the next status of it."""
        now_s = time.monotonic()
        # As old as this was the one before, just before this one came.
        self.oldest_s = max(self.oldest_s, device["age_s"], self._age_s + now_s - self._at_s)
        self.missed += device["heard_s"] < self._heard_s or device["age_s"] > OLD_S
        self._heard_s, self._at_s, self._age_s = device["heard_s"], now_s, device["age_s"]


@contextmanager
def listening(port: int, device: str) -> Iterator[Told]:
    """Listen to a device; yield what is heard."""
    told, is_over = Told(), threading.Event()

    def listen() -> None:
        with connect(f"ws://127.0.0.1:{port}/api/v1/devices/events", max_size=None) as socket:
            while not is_over.is_set():
                [view] = [each for each in json.loads(socket.recv(timeout=60))["devices"] if each["id"] == device]
                told.hear(view)

    with ThreadPoolExecutor(1) as pool:
        listener = pool.submit(listen)
        try:
            yield told
        finally:
            is_over.set()
        listener.result()


@contextmanager
def stopping(port: int, device: str, *, moves: bool) -> Iterator[list[float]]:
    """Stop a device now and then, and have it move on if it does; yield how long each stop took [ms]."""
    times_ms: list[float] = []
    is_over = threading.Event()

    def stop() -> None:
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
        while not is_over.wait(STOP_EVERY_S):
            began_s = time.perf_counter()
            connection.request("POST", f"/api/v1/devices/{device}/stop")
            connection.getresponse().read()
            times_ms.append((time.perf_counter() - began_s) * 1000)
            if moves:
                move(port, device)

    with ThreadPoolExecutor(1) as pool:
        stopper = pool.submit(stop)
        try:
            yield times_ms
        finally:
            is_over.set()
        stopper.result()


def ask(port: int, method: str, path: str, body: dict[str, Any] | None = None) -> tuple[int, Any]:
    """Return status and content of an answer of the API."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=600)
    text, headers = json.dumps(body) if body else None, {"content-type": "application/json"}
    connection.request(method, f"/api/v1{path}", text, headers)
    answer = connection.getresponse()
    return answer.status, json.loads(answer.read())


def move(port: int, device: str) -> None:
    """Have a device move, for longer than all that is measured.

    Right after a stop a busy server may count a new connection as older than that: then it is asked again.
    """
    while ask(port, "POST", f"/devices/{device}/move", {"by_steps": 1_000_000})[0] == 409:
        time.sleep(0.02)


def cpu_s(process: psutil.Process) -> float:
    """Return the CPU time that a process has taken [s]."""
    times = process.cpu_times()
    return float(times.user + times.system)


def settle(process: psutil.Process) -> None:
    """Wait until a server and its processes have compiled their numerics."""
    while True:
        every = [process, *process.children()]
        before_s = sum(map(cpu_s, every))
        time.sleep(2.0)
        if sum(map(cpu_s, every)) - before_s < 0.2:
            return


def line(port: int, process: psutil.Process, count: int, device: str, *, moves: bool) -> None:
    """Print what so many clients have measured."""
    command = [sys.executable, __file__, str(port), str(count), str(MEASURED_S)]
    others = process.children()
    with listening(port, device) as told, stopping(port, device, moves=moves) as stops_ms:
        before_s, others_before_s = cpu_s(process), sum(map(cpu_s, others))
        measured = json.loads(subprocess.run(command, capture_output=True, check=True, text=True).stdout)
        server_s, others_s = cpu_s(process) - before_s, sum(map(cpu_s, others)) - others_before_s
    times_ms = measured["latencies_ms"]
    answers = len(times_ms)
    median, p99 = np.percentile(times_ms, [50, 99])
    cells = (f"{answers / MEASURED_S:.0f}", f"{median:.1f}", f"{p99:.1f}", f"{max(times_ms):.1f}")
    cells += tuple(f"{each_s / answers * 1000:.2f}" for each_s in (server_s, others_s, measured["cpu_s"]))
    cells += (f"{np.median(stops_ms):.1f}", f"{max(stops_ms):.1f}", f"{told.oldest_s * 1000:.0f}", f"{told.missed}")
    print(f"| {'moves' if moves else 'at rest'} | {count} | {' | '.join(cells)} |", flush=True)


def memory(port: int, process: psutil.Process) -> None:
    """Print what becomes of plans that together are larger than there is memory for."""
    body = {"designs": [long_ramp(STEPS, int(0.45 * STEPS))] * AXES, "mode": "independent", "max_points": 1000}
    began_s = time.monotonic()
    with ThreadPoolExecutor(TOGETHER) as pool:
        asked = [pool.submit(ask, port, "POST", "/schedule", body) for _ in range(TOGETHER)]
        answers = [each.result() for each in asked]
    took_s = time.monotonic() - began_s
    print(f"\n{TOGETHER} schedules of {AXES} axes of {STEPS:,} steps each, at once, took {took_s:.0f} s:")
    for status, content in answers:
        reason = content["errors"][0]["message"] if status != 200 else f"{len(content['axes'])} axes"
        print(f"- {status}: {reason}")
    peak_kb = int(Path(f"/proc/{process.pid}/status").read_text().partition("VmHWM:")[2].split()[0])
    print(
        f"\nThe server had {peak_kb / 1024:,.0f} MiB at most, {process.memory_info().rss / 2**20:,.0f} MiB afterwards."
    )


def client_load() -> None:
    """Print the table, and what memory is needed."""
    print(
        "| device | clients | answers/s | median ms | p99 | longest | server | others | clients | stop |"
        " longest | told | missed |"
    )
    print("|---|" + "---:|" * 12)
    with Server() as server:
        process = psutil.Process(server.pid)
        device = ask(server.port, "POST", "/devices", {"port": "sim://"})[1]["id"]
        ask(server.port, "POST", f"/devices/{device}/push", {"design": document()})
        settle(process)
        # The others are begun when they are needed.
        asyncio.run(ask_together(server.port, max(CLIENTS), 1.0))
        settle(process)
        for count in CLIENTS:
            line(server.port, process, count, device, moves=False)
        move(server.port, device)
        for count in CLIENTS:
            line(server.port, process, count, device, moves=True)
        ask(server.port, "POST", f"/devices/{device}/stop")
        memory(server.port, process)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        taken_ms = asyncio.run(ask_together(int(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3])))
        used = resource.getrusage(resource.RUSAGE_SELF)
        print(json.dumps({"latencies_ms": taken_ms, "cpu_s": used.ru_utime + used.ru_stime}))
    else:
        client_load()
