"""What WebSockets do with messages that make no sense, and when something goes wrong."""

from __future__ import annotations

import itertools
import json
from typing import Any

import pytest
from starlette.testclient import TestClient
from starlette.types import Message
from starlette.websockets import WebSocketDisconnect
from uvicorn.protocols.utils import ClientDisconnected

from designs import document
from event_loop import run
from stepramp.controllers.virtual.controller import VirtualController
from stepramp.devices.device import Device
from stepramp.devices.registry import Devices
from stepramp.http_api import sockets
from stepramp.http_api.curves_models import CurvesAnswer
from stepramp.link import protocol_sim

LOCAL = {"host": "127.0.0.1:8000"}
EVENTS = "/api/v1/devices/events"
CURVES = "/api/v1/curves/socket"
ODD_MESSAGES: list[str | bytes] = [
    b"\xff\x00", b"", b"{}", "", "{", "null", "5", "[]", '"\\ud800"', '{"\\ud800": 1}', "[" * 900 + "]" * 900,
    "[" * 10**5, "9" * 5000, "NaN",
]  # fmt: skip
_numbers = itertools.count()


@pytest.fixture
def jog(client: TestClient) -> str:
    """Return the path of the socket that jogs a device with a ramp."""
    port = f"sim://sockets-{next(_numbers)}"
    protocol_sim.register(port, VirtualController())
    route = f"/api/v1/devices/{client.post('/api/v1/devices', json={'port': port}).json()['id']}"
    assert client.post(f"{route}/push", json={"design": document()}).status_code == 200
    return f"{route}/jog"


def opened(client: TestClient, path: str) -> Any:
    return client.websocket_connect(path, headers=LOCAL)


def say(socket: Any, message: str | bytes) -> None:
    if isinstance(message, bytes):
        socket.send_bytes(message)
    else:
        socket.send_text(message)


def refused(socket: Any, message: str | bytes) -> dict[str, Any]:
    say(socket, message)
    answer = socket.receive_text()
    assert len(answer) < 2000
    error: dict[str, Any] = json.loads(answer)["errors"][0]
    assert {"field", "value", "allowed", "message"} <= set(error)
    return error


@pytest.mark.parametrize("message", ODD_MESSAGES, ids=lambda message: repr(message[:12]))
def test_odd_messages_are_refused_and_the_socket_goes_on(client: TestClient, jog: str, message: str | bytes) -> None:
    with opened(client, jog) as socket:
        assert refused(socket, message)["allowed"]
        assert refused(socket, '{"do": "nothing"}')["field"] == "do"
    with opened(client, CURVES) as socket:
        assert refused(socket, message)["allowed"]
        socket.send_json({"design": document(), "methods": ["exact"]})
        assert "errors" not in socket.receive_json()
    with opened(client, EVENTS) as socket:
        assert socket.receive_json()["devices"]
        say(socket, message)
        while "errors" not in (heard := socket.receive_json()):
            assert heard["devices"]
        assert heard["errors"][0]["allowed"]
        client.delete(jog.removesuffix("/jog"))
        while socket.receive_json()["devices"]:
            pass


def test_a_binary_message_is_called_so(client: TestClient, jog: str) -> None:
    for path in (jog, CURVES):
        with opened(client, path) as socket:
            error = refused(socket, b"\xff" * 10)
            assert (error["field"], error["value"]) == ("message", "10 bytes")
            assert error["allowed"].endswith(", as text")


def test_a_long_message_of_a_jog_is_refused_unread(client: TestClient, jog: str) -> None:
    with opened(client, jog) as socket:
        error = refused(socket, '{"do": "hold", "x": "' + "x" * 1024 + '"}')
        assert error["allowed"].endswith("of up to 1,024 characters")


def test_so_many_speeds_wait_for_the_controller_at_most(
    client: TestClient, jog: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As of a program that asks for one after the other without waiting: others want their turns."""
    monkeypatch.setattr("stepramp.http_api.jog.MOST_BEGINNING", 0)
    with opened(client, jog) as socket:
        socket.send_json({"do": "run", "axis": 0, "speed_steps_per_s": 400})
        [error] = socket.receive_json()["errors"]
    assert "speeds wait for the controller already" in error["message"]


def test_a_message_without_sense_ends_the_jog(client: TestClient, jog: str) -> None:
    with opened(client, EVENTS) as events, opened(client, jog) as socket:
        socket.send_json({"do": "run", "axis": 0, "speed_steps_per_s": 400})
        while events.receive_json()["devices"][0]["state"] != "moving":
            socket.send_json({"do": "hold"})
        refused(socket, b"\0")
        while events.receive_json()["devices"][0]["state"] not in ("stopping", "ready"):
            pass


def test_a_jog_s_change_of_speed_that_comes_late_begins_nothing(client: TestClient, jog: str) -> None:
    with opened(client, EVENTS) as events, opened(client, jog) as socket:
        socket.send_json({"do": "run", "axis": 0, "speed_steps_per_s": 400})
        while events.receive_json()["devices"][0]["state"] != "moving":
            socket.send_json({"do": "hold"})
        while events.receive_json()["devices"][0]["state"] != "ready":
            pass
        socket.send_json({"do": "run", "axis": 0, "speed_steps_per_s": 300})
        assert "was not told to go on for 0.4 s" in socket.receive_json()["errors"][0]["message"]


def mistaken(*_: object) -> Any:
    raise RuntimeError("a mistake of ours")


def read_for_ever(socket: Any) -> None:
    while True:
        socket.receive_text()


def assert_closed_as_a_mistake(socket: Any, caplog: pytest.LogCaptureFixture) -> None:
    with pytest.raises(WebSocketDisconnect) as caught:
        read_for_ever(socket)
    assert caught.value.code == sockets.MISTAKE
    assert "a mistake of ours" in caplog.text


def test_a_mistake_in_an_answer_is_logged_and_closes_the_socket(
    client: TestClient, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(CurvesAnswer, "of", mistaken)
    with opened(client, CURVES) as socket:
        socket.send_json({"design": document(), "methods": ["exact"]})
        assert_closed_as_a_mistake(socket, caplog)


def test_a_mistake_in_what_is_told_is_logged_and_closes_the_socket(
    client: TestClient, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(Devices, "views", mistaken)
    with opened(client, EVENTS) as socket:
        assert_closed_as_a_mistake(socket, caplog)


@pytest.mark.parametrize("what", ["run", "end_run"])
def test_a_mistake_in_a_jog_is_logged_and_closes_the_socket(
    client: TestClient, jog: str, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, what: str
) -> None:
    monkeypatch.setattr(Device, what, mistaken)
    with opened(client, jog) as socket:
        socket.send_json({"do": "run", "axis": 0, "speed_steps_per_s": 400})
        socket.send_json({"do": "end"})
        assert_closed_as_a_mistake(socket, caplog)


def test_who_goes_before_the_socket_is_accepted_is_no_mistake(
    client: TestClient, jog: str, caplog: pytest.LogCaptureFixture
) -> None:
    """As a page does that is stopped while it opens a jog."""

    async def said() -> Message:
        return {"type": "websocket.connect"}

    async def gone(message: Message) -> None:
        raise ClientDisconnected(message["type"])

    assert client.portal
    for path in (jog, CURVES, EVENTS):
        scope = {"type": "websocket", "path": path, "query_string": b"", "headers": [(b"host", b"127.0.0.1:8000")]}
        client.portal.call(client.app, scope, said, gone)
        assert "mistake" not in caplog.text


class Gone:
    """A socket whose other end has gone, as Starlette or the server tell."""

    def __init__(self, error: Exception) -> None:
        self._error = error

    async def send(self, _: Message) -> None:
        raise self._error


@pytest.mark.parametrize("error", [RuntimeError("after sending 'websocket.close'"), WebSocketDisconnect(1006)])
def test_sending_to_who_has_gone_tells_so(error: Exception) -> None:
    with pytest.raises(WebSocketDisconnect):
        run(sockets.send(Gone(error), "x"))


def test_a_page_that_is_named_twice_is_refused(client: TestClient, jog: str) -> None:
    """Which of them is meant, nobody knows."""
    for path in (jog, EVENTS):
        with opened(client, f"{path}?page=one&page=other") as socket:
            [error] = socket.receive_json()["errors"]
            assert (error["field"], error["value"]) == ("page", ["one", "other"])
            assert error["allowed"] == "one value, given once"
            with pytest.raises(WebSocketDisconnect) as closed:
                socket.receive_json()
            assert closed.value.code == 1008
