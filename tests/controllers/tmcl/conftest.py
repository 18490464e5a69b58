from __future__ import annotations

from collections.abc import Iterator

import pytest

from controllers.bench import PlugIn
from controllers.conftest import Clock
from controllers.tmcl.bench import Bench
from controllers.tmcl.emulator import TmclEmulator
from designs import design
from stepramp.controllers.tmcl import conversation
from stepramp.controllers.tmcl.controller import TmclController


@pytest.fixture
def bench(clock: Clock, plug_in: PlugIn, monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    monkeypatch.setattr(conversation, "ANSWER_S", 0.03)
    monkeypatch.setattr(conversation, "STORING_S", 0.03)
    bench = Bench(clock, plug_in, TmclEmulator(clock))
    yield bench
    bench.port.close()


@pytest.fixture
def module(bench: Bench) -> TmclEmulator:
    return bench.module


@pytest.fixture
def controller(bench: Bench) -> TmclController:
    """Return a client that is connected, with a ramp of 1000 steps/s and 5000 steps/s² in use."""
    bench.controller.connect()
    bench.controller.prepare_push([design()], 0, "try")()
    bench.module.commands.clear()
    return bench.controller


@pytest.fixture
def six(clock: Clock, plug_in: PlugIn, monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    """Return a module of six motors."""
    monkeypatch.setattr(conversation, "ANSWER_S", 0.03)
    bench = Bench(clock, plug_in, TmclEmulator(clock, number=6212, axes=6))
    bench.controller.connect()
    yield bench
    bench.port.close()
