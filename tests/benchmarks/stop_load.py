"""What a server is kept busy with while stops are timed: plannings, connects to ports nobody answers at, WebSockets.

usage: python tests/benchmarks/stop_load.py PORT SECONDS    (prints "ready" once all is under way, ends by itself)
"""

import asyncio
import json
import os
import sys
import tty
from collections import Counter
from itertools import count
from typing import Any

from designs import document

PLANNINGS = CONNECTS = 45
EVENTS_SOCKETS = CURVES_SOCKETS = 130
"""With the requests nearly as many as a server takes: 384."""
CURVES_PAUSE_S = 10.0
REFUSED_PAUSE_S = 0.5
STEPS = 10_000_000
LONGEST_FIT = 60_000
"""A longer ramp is refused: a table's indices have 16 bits [steps]."""
PIECE_BYTES = 2**16
HANDSHAKE = (
    "GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n\r\n"
)


def long_ramp(steps: int, ramp_steps: int) -> dict[str, Any]:
    """Return a design of a move of so many steps, with a ramp of so many at each end."""
    return document(
        timer={"frequency_hz": 16_000_000, "counter_bits": 32, "shortest_interval_us": 20},
        ramp__slew_speed_steps_per_s=2000,
        ramp__acceleration_steps_per_s2=2000**2 / (2 * ramp_steps),
        move__steps=steps,
    )


def plannings() -> list[tuple[str, dict[str, Any]]]:
    """Return routes and bodies of the largest requests that are accepted."""
    design = long_ramp(STEPS, int(0.45 * STEPS))
    methods = ["exact", "first_order", "second_order"]
    return [
        ("profile", {"design": design}),
        ("profile", {"design": design, "max_points": 2000}),
        ("errors", {"design": design, "methods": methods}),
        ("curves", {"design": design, "methods": methods, "parts": True, "acceleration": True}),
        ("table/fit", {"design": long_ramp(STEPS, LONGEST_FIT), "rows": 1000, "row_kind": "linear"}),
        ("schedule", {"designs": [design, design], "mode": "line"}),
    ]


class Load:
    """All that goes on at one server."""

    def __init__(self, port: int) -> None:
        self._port = port
        self.done: Counter[str] = Counter()

    async def post_for_ever(self, requests: list[tuple[str, dict[str, Any]]], first: int = 0) -> None:
        """Send requests one after the other, and read the answers away."""
        bodies = [(route, json.dumps(body).encode()) for route, body in requests]
        for number in count(first):
            route, body = bodies[number % len(bodies)]
            reader, writer = await self._connection()
            head = f"POST /api/v1/{route} HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n"
            head += f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n\r\n"
            writer.write(head.encode() + body)
            try:
                status = (await reader.readline()).decode()[9:12]
                while await reader.read(PIECE_BYTES):
                    pass
            except ConnectionError:
                status = "ended"
            writer.close()
            self.done[f"{route} {status}"] += 1

    async def events(self) -> None:
        """Listen to the devices' events."""
        reader, _ = await self._socket("/api/v1/devices/events")
        while data := await reader.read(PIECE_BYTES):
            self.done["events bytes"] += len(data)

    async def curves(self, number: int) -> None:
        """Ask for curves over a socket now and then."""
        reader, writer = await self._socket("/api/v1/curves/socket")
        text = json.dumps({"design": document(), "methods": ["exact", "newton"], "max_points": 400}).encode()
        await asyncio.sleep(CURVES_PAUSE_S * number / CURVES_SOCKETS)
        while True:
            # A frame of text, its length in 16 bits, masked by nothing.
            writer.write(b"\x81\xfe" + len(text).to_bytes(2, "big") + bytes(4) + text)
            await reader.read(PIECE_BYTES)
            self.done["curves messages"] += 1
            await asyncio.sleep(CURVES_PAUSE_S)

    async def _socket(self, path: str) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        """Return a socket; where the server has enough of them, once it takes one more."""
        while True:
            reader, writer = await self._connection()
            writer.write(HANDSHAKE.format(path=path).encode())
            try:
                if (await reader.readuntil(b"\r\n\r\n")).startswith(b"HTTP/1.1 101"):
                    return reader, writer
            except (ConnectionError, asyncio.IncompleteReadError):
                pass
            writer.close()
            self.done["sockets refused"] += 1
            await asyncio.sleep(REFUSED_PAUSE_S)

    async def _connection(self) -> tuple[asyncio.StreamReader, asyncio.StreamWriter]:
        return await asyncio.open_connection("127.0.0.1", self._port)


def mute_port() -> str:
    """Return a serial port at which nobody answers; it lasts as long as this process."""
    _, near_end = os.openpty()
    tty.setraw(near_end)
    return os.ttyname(near_end)


async def load(port: int, seconds: float) -> Counter[str]:
    """Keep a server busy for so long; return what it did."""
    all_of_it, requests = Load(port), plannings()
    works = [all_of_it.events() for _ in range(EVENTS_SOCKETS)]
    works += [all_of_it.curves(number) for number in range(CURVES_SOCKETS)]
    works += [all_of_it.post_for_ever([("devices", {"port": mute_port()})]) for _ in range(CONNECTS)]
    works += [all_of_it.post_for_ever(requests, number) for number in range(PLANNINGS)]
    tasks = [asyncio.create_task(work) for work in works]
    await asyncio.sleep(2.0)
    print("ready", flush=True)
    ended, _ = await asyncio.wait(tasks, timeout=seconds, return_when=asyncio.FIRST_EXCEPTION)
    for task in ended:
        task.result()
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
    return all_of_it.done


if __name__ == "__main__":
    print(json.dumps(asyncio.run(load(int(sys.argv[1]), float(sys.argv[2])))), flush=True)
