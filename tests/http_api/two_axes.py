"""A device at a virtual port with two axes that have a ramp, over HTTP."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

from starlette.testclient import TestClient

from designs import document
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.link import protocol_sim
from waiting import until

DEVICES = "/api/v1/devices"
LOCAL = {"host": "127.0.0.1:8000"}
_numbers = itertools.count()


def port_of(board: VirtualController) -> str:
    """Return a virtual port of its own at which a controller is."""
    port = f"sim://two-axes-{next(_numbers)}"
    protocol_sim.register(port, board)
    return port


def device_of(ask: Callable[[str, str, Any], Any]) -> str:
    port = port_of(VirtualController())
    route = f"{DEVICES}/{ask('POST', DEVICES, {'port': port})['id']}"
    assert ask("POST", f"{route}/push", {"axes": [document(), document()]})["verified"]
    return route


def until_state(client: TestClient, route: str, state: str) -> None:
    until(lambda: client.get(route).json()["state"] == state)


def error_of(response: Any, status: int) -> dict[str, Any]:
    assert response.status_code == status, response.text
    [error] = response.json()["errors"]
    return dict(error)
