from __future__ import annotations

from collections.abc import Iterator

import pytest

from controllers.conftest import Clock
from controllers.klipper.bench import Bench
from controllers.klipper.moonraker import Moonraker
from controllers.klipper.printer import Printer
from stepramp.controllers.klipper import conversation, moves, stopping
from stepramp.controllers.klipper.controller import KlipperController


@pytest.fixture(autouse=True)
def _soon(monkeypatch: pytest.MonkeyPatch) -> None:
    """Answers come at once or not at all here."""
    for name in ("ANSWER_S", "SCRIPT_S", "GREETING_S"):
        monkeypatch.setattr(conversation, name, 0.1)
    monkeypatch.setattr(conversation, "AGAIN_S", 0.01)
    monkeypatch.setattr(moves, "BUSY_S", 0.05)
    for name in ("SCRIPTS_S", "SHUT_DOWN_S"):
        monkeypatch.setattr(stopping, name, 0.1)


@pytest.fixture
def bench(clock: Clock) -> Iterator[Bench]:
    bench = Bench(clock)
    yield bench
    assert bench.moonraker.wrong == []


@pytest.fixture
def controller(bench: Bench) -> KlipperController:
    """Return a client that is connected: 80 steps/mm in x, 300 mm/s and 3000 mm/s²; it stands at 100 mm."""
    return bench.connected()


@pytest.fixture
def printer(bench: Bench) -> Printer:
    return bench.printer


@pytest.fixture
def moonraker(bench: Bench) -> Moonraker:
    return bench.moonraker
