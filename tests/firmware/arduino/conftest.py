from collections.abc import Callable
from pathlib import Path

import pytest

from firmware.arduino.board import build, missing
from simulator.avr import SimulatedController
from tools import require


@pytest.fixture(scope="session")
def arduino_tools() -> None:
    require(*missing())


@pytest.fixture
def simulated_uno(tmp_path: Path) -> Callable[..., SimulatedController]:
    """Return a function that makes a simulated Uno with an example on it; not started yet."""
    require(*missing())

    def make(
        example: str, *, real_time: bool = False, press: tuple[int, int, int] | None = None
    ) -> SimulatedController:
        return SimulatedController(build(example).elf, tmp_path, real_time=real_time, press=press)

    return make
