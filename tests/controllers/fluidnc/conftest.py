from __future__ import annotations

from collections.abc import Iterator

import pytest

from controllers.conftest import Clock
from controllers.fluidnc.emulator import FluidNcEmulator
from controllers.grbl.bench import Bench, PlugIn
from controllers.grbl.emulator import Eeprom
from stepramp.controllers.fluidnc.controller import FluidNcController
from stepramp.controllers.grbl import conversation
from stepramp.link import protocol_sim


class FluidNcBench(Bench):
    """A FluidNC whose clock tests set, and a client of it."""

    client = FluidNcController

    def plugged_in(self, eeprom: Eeprom | None) -> FluidNcEmulator:  # noqa: ARG002  # it has a file instead
        return FluidNcEmulator(self.clock)


@pytest.fixture
def bench(clock: Clock, plug_in: PlugIn, monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    monkeypatch.setattr(conversation, "KNOCK_S", 0.02)
    # As long as it takes: each question here has an answer.
    monkeypatch.setattr(conversation, "ANSWER_S", 5.0)
    monkeypatch.setattr(conversation, "GREETING_S", 0.3)
    monkeypatch.setattr(protocol_sim, "LISTEN_S", 0.0001)
    bench = FluidNcBench(clock, plug_in)
    yield bench
    bench.port.close()


@pytest.fixture
def fluidnc(bench: Bench) -> FluidNcEmulator:
    assert isinstance(bench.grbl, FluidNcEmulator)
    return bench.grbl


@pytest.fixture
def controller(bench: Bench) -> FluidNcController:
    """Return a client that is connected: 250 steps/mm, 500 mm/min and 10 mm/s² in each axis."""
    bench.controller.connect()
    bench.grbl.lines.clear()
    assert isinstance(bench.controller, FluidNcController)
    return bench.controller
