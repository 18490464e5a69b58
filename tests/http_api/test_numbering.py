"""Requests are as old as their first byte: over real connections to the server's process."""

from __future__ import annotations

import json
import socket
from collections.abc import Iterator

import pytest

from designs import document
from server_process import ServerProcess


@pytest.fixture(scope="module")
def server() -> Iterator[ServerProcess]:
    with ServerProcess(8950) as server:
        server.ask("POST", "devices", {"port": "sim://"})
        server.ask("POST", "devices/1/push", {"design": document(), "mode": "try"})
        yield server


def request(server: ServerProcess, route: str, body: object) -> bytes:
    text = json.dumps(body).encode()
    head = f"POST /api/v1/{route} HTTP/1.1\r\nHost: 127.0.0.1:{server.address.port}\r\n"
    head += f"Content-Type: application/json\r\nContent-Length: {len(text)}\r\n\r\n"
    return head.encode() + text


def answers(connection: socket.socket, count: int) -> bytes:
    """Return what comes until so many answers have begun, and the last of them has come whole."""
    data = b""
    while data.count(b"HTTP/1.1 ") < count or not data.rstrip().endswith((b"}", b"]")):
        data += connection.recv(65_536)
    return data


@pytest.fixture
def connection(server: ServerProcess) -> Iterator[socket.socket]:
    with socket.create_connection((server.address.hostname, server.address.port), timeout=60) as connection:
        yield connection


def test_a_move_behind_another_request_of_its_connection(server: ServerProcess, connection: socket.socket) -> None:
    slow = {"design": document(move__steps=3_000_000), "max_points": 100}
    move = request(server, "devices/1/move", {"by_steps": 50})
    connection.sendall(request(server, "profile", slow) + move)
    server.ask("POST", "devices/stop")
    assert b"A stop came first" in answers(connection, 2)
    connection.sendall(move)
    assert b"200 OK" in answers(connection, 1)
    server.ask("POST", "devices/1/halt")


def test_a_move_whose_head_comes_in_drops(server: ServerProcess, connection: socket.socket) -> None:
    move = request(server, "devices/1/move", {"by_steps": 50})
    connection.sendall(move[:40])
    while not server.ask("GET", "devices")["devices"]:
        pass
    server.ask("POST", "devices/1/stop")
    connection.sendall(move[40:])
    assert b"A stop came first" in answers(connection, 1)
    connection.sendall(move)
    assert b"200 OK" in answers(connection, 1)
    server.ask("POST", "devices/1/halt")
