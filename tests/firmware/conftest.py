from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from simulator.avr import SimulatedController, build_firmware, build_harness, missing_tools
from tools import require


@pytest.fixture
def simulated_controller(tmp_path: Path) -> Callable[..., SimulatedController]:
    """Return a function that makes a simulated controller, with the options of SimulatedController; not started yet."""
    require(*missing_tools())
    build_harness()
    return partial(SimulatedController, build_firmware(), tmp_path)
