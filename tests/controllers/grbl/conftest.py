from __future__ import annotations

from collections.abc import Iterator

import pytest

from controllers.conftest import Clock
from controllers.grbl.bench import Bench, PlugIn
from controllers.grbl.emulator import GrblEmulator
from stepramp.controllers.grbl import conversation
from stepramp.controllers.grbl.controller import GrblController
from stepramp.link import protocol_sim


@pytest.fixture
def bench(clock: Clock, plug_in: PlugIn, monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    monkeypatch.setattr(conversation, "KNOCK_S", 0.02)
    monkeypatch.setattr(conversation, "ANSWER_S", 0.3)
    monkeypatch.setattr(conversation, "GREETING_S", 0.3)
    monkeypatch.setattr(protocol_sim, "LISTEN_S", 0.0001)
    bench = Bench(clock, plug_in)
    yield bench
    bench.port.close()


@pytest.fixture
def grbl(bench: Bench) -> GrblEmulator:
    return bench.grbl


@pytest.fixture
def controller(bench: Bench) -> GrblController:
    """Return a client that is connected: 250 steps/mm, 500 mm/min and 10 mm/s², as grbl comes."""
    bench.controller.connect()
    bench.grbl.lines.clear()
    return bench.controller
