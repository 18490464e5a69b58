"""The client of the protocol against scripts, with nothing left over."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from controllers.client.script import SESSION, Connect, Script
from stepramp.controllers.stepramp import conversation
from stepramp.controllers.stepramp.controller import StepRampController
from stepramp.link.serial_port import SerialPort


@pytest.fixture(autouse=True)
def _quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(conversation, "_new_session", lambda: SESSION)
    monkeypatch.setattr(conversation, "GARBAGE_S", 0.0)
    monkeypatch.setattr(conversation, "REPLY_TIMEOUT_S", 0.01)
    monkeypatch.setattr(conversation, "HELLO_INTERVAL_S", 0.01)


@pytest.fixture
def connect(plug_in: Callable) -> Iterator[Connect]:
    """Connect to a script; at the end nothing of it may be left over."""
    used: list[tuple[SerialPort, Script]] = []

    def connect(script: Script) -> StepRampController:
        port = SerialPort(plug_in(script))
        used.append((port, script))
        controller = StepRampController(port)
        controller.connect()
        return controller

    yield connect
    for port, script in used:
        assert script.pairs == []
        port.close()
