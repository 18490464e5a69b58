"""Measure how long a small profile takes when 1, 50 and 200 clients compute at once, at rest and while a device moves.

usage: PYTHONPATH=tests python tests/benchmarks/client_load.py

The server and the clients are processes of their own. Each client keeps a connection and asks for its next profile as
soon as it has the last one; no client pauses. `events` is the longest time between two states that somebody hears who
listens to the devices meanwhile: at most 1 s at rest, when nothing changes.

usage: python tests/benchmarks/client_load.py PORT CLIENTS SECONDS      (the clients: prints latencies [ms], as JSON)
"""

import asyncio
import http.client
import json
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from websockets.sync.client import connect

from browser.server import Server
from designs import document

CLIENTS = (1, 50, 200)
MEASURED_S, SETTLED_S = 8.0, 4.0


async def ask_for_ever(port: int, until_s: float, latencies_ms: list[float]) -> None:
    """Ask for one profile after the other over one connection."""
    body = json.dumps({"design": document(), "max_points": 200}).encode()
    head = f"POST /api/v1/profile HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Type: application/json\r\n"
    request = f"{head}Content-Length: {len(body)}\r\n\r\n".encode() + body
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    while time.monotonic() < until_s:
        began = time.perf_counter()
        writer.write(request)
        answer = await reader.readuntil(b"\r\n\r\n")
        assert answer.startswith(b"HTTP/1.1 200"), answer
        size = answer.lower().partition(b"content-length: ")[2].partition(b"\r\n")[0]
        await reader.readexactly(int(size))
        latencies_ms.append((time.perf_counter() - began) * 1000)
    writer.close()


async def clients(port: int, count: int, seconds: float) -> list[float]:
    """Have so many clients ask for so long; return how long each answer took [ms]."""
    latencies_ms: list[float] = []
    until_s = time.monotonic() + seconds
    await asyncio.gather(*(ask_for_ever(port, until_s, latencies_ms) for _ in range(count)))
    return latencies_ms


def longest_silence_ms(port: int, seconds: float) -> float:
    """Listen to the devices for so long; return the longest time between two states [ms]."""
    longest_s, until_s = 0.0, time.monotonic() + seconds
    with connect(f"ws://127.0.0.1:{port}/api/v1/devices/events", max_size=None) as socket:
        socket.recv()
        last_s = time.monotonic()
        while (now_s := time.monotonic()) < until_s:
            socket.recv(timeout=60)
            now_s = time.monotonic()
            longest_s, last_s = max(longest_s, now_s - last_s), now_s
    return longest_s * 1000


def ask(port: int, method: str, path: str, body: dict[str, Any] | None = None) -> Any:
    """Return the answer of the API."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    connection.request(
        method, f"/api/v1{path}", json.dumps(body) if body else None, {"content-type": "application/json"}
    )
    answer = connection.getresponse()
    content = answer.read()
    assert answer.status == 200, content
    return json.loads(content)


def line(name: str, port: int, count: int) -> None:
    """Print what so many clients have measured."""
    command = [sys.executable, __file__, f"{port}", f"{count}", f"{MEASURED_S}"]
    with ThreadPoolExecutor(1) as listening:
        silence = listening.submit(longest_silence_ms, port, MEASURED_S)
        measured = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
    median, p99 = np.percentile(measured, [50, 99])
    rate = len(measured) / MEASURED_S
    print(f"{name:<14}{count:>9}{rate:>12.0f}{median:>11.1f}{p99:>9.1f}{max(measured):>11.1f}{silence.result():>11.0f}")


def client_load() -> None:
    """Print the table."""
    print("small profile  clients   answers/s  median ms   p99 ms  longest ms  events ms")
    with Server() as server:
        port = int(server.url.rstrip("/").rpartition(":")[2])
        time.sleep(SETTLED_S)
        for count in CLIENTS:
            line("at rest", port, count)
        device = ask(port, "POST", "/devices", {"port": "sim://"})["id"]
        ask(port, "POST", f"/devices/{device}/push", {"design": document()})
        # Longer than all that is measured.
        ask(port, "POST", f"/devices/{device}/move", {"by_steps": 1_000_000})
        for count in CLIENTS:
            line("a device moves", port, count)
        ask(port, "POST", f"/devices/{device}/stop")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        print(json.dumps(asyncio.run(clients(int(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3])))))
    else:
        client_load()
