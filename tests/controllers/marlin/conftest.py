from __future__ import annotations

from collections.abc import Iterator

import pytest

from controllers.bench import PlugIn
from controllers.conftest import Clock
from controllers.marlin.bench import Bench
from controllers.marlin.emulator import MarlinEmulator
from stepramp.controllers.marlin import conversation, exchange, moves
from stepramp.controllers.marlin.controller import MarlinController
from stepramp.link import lines, serial_port


@pytest.fixture
def bench(clock: Clock, plug_in: PlugIn, monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    for module in (conversation, exchange, moves, lines):
        monkeypatch.setattr(module, "monotonic", clock)
    # It gives way after each look at what has come in.
    monkeypatch.setattr(lines, "GIVE_WAY_S", 0.0)
    monkeypatch.setattr(serial_port, "_READ_SLICE_S", 0.0)
    bench = Bench(clock, plug_in)
    yield bench
    bench.port.close()


@pytest.fixture
def marlin(bench: Bench) -> MarlinEmulator:
    return bench.marlin


@pytest.fixture
def controller(bench: Bench) -> MarlinController:
    """Return a client that is connected: X has 80 steps/mm, 500 mm/s and 500 mm/s²."""
    bench.controller.connect()
    bench.marlin.lines.clear()
    return bench.controller
