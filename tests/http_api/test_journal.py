"""The journal: who asked what of devices."""

import logging
import re

import pytest
from starlette.testclient import TestClient

DEVICES = "/api/v1/devices"
LOCAL = {"host": "127.0.0.1:8000"}


def test_who_asked_what_is_told(client: TestClient, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, "stepramp")
    client.get(DEVICES)
    client.post(f"{DEVICES}/9/move", json={"by_steps": 5}, headers={"X-StepRamp-Page": "one"})
    client.post(f"{DEVICES}/stop")
    with client.websocket_connect(f"{DEVICES}/events?page=two", headers=LOCAL) as socket:
        socket.receive_json()
    lines = [each.getMessage() for each in caplog.records if each.name == "stepramp.http_api.journal"]
    assert [re.sub("[0-9]+ ms", "# ms", line) for line in lines] == [
        "POST /api/v1/devices/9/move, asked for by page 'one': 404 after # ms",
        "POST /api/v1/devices/stop, asked for by a program: 200 after # ms",
        "WebSocket /api/v1/devices/events, asked for by page 'two': ended after # ms",
    ]


def test_nothing_is_told_unasked(client: TestClient, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.WARNING, "stepramp")
    client.post(f"{DEVICES}/stop")
    assert not [each for each in caplog.records if each.name == "stepramp.http_api.journal"]
