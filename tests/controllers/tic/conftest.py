from __future__ import annotations

from collections.abc import Iterator

import pytest

from controllers.bench import PlugIn
from controllers.conftest import Clock
from controllers.tic.bench import Bench
from controllers.tic.emulator import TicEmulator
from designs import design
from stepramp.controllers.tic import conversation
from stepramp.controllers.tic.controller import TicController


@pytest.fixture
def bench(clock: Clock, plug_in: PlugIn, monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    monkeypatch.setattr(conversation, "ANSWER_S", 0.03)
    bench = Bench(clock, plug_in)
    yield bench
    bench.port.close()


@pytest.fixture
def tic(bench: Bench) -> TicEmulator:
    return bench.tic


@pytest.fixture
def controller(bench: Bench) -> TicController:
    """Return a client that is connected, with a ramp of 1000 steps/s and 5000 steps/s² in use."""
    bench.controller.connect()
    bench.controller.prepare_push([design()], 0, "try")()
    bench.tic.commands.clear()
    return bench.controller
