from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import pytest

from firmware.host import Host, build, missing_compiler
from simulator.avr import SimulatedController, build_firmware, build_harness, missing_tools
from tools import require


@pytest.fixture(scope="session")
def host_program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    require(*missing_compiler())
    return build(tmp_path_factory.mktemp("host"))


@pytest.fixture(scope="module")
def host(host_program: Path) -> Iterator[Host]:
    with Host(host_program) as running:
        yield running


@pytest.fixture
def simulated_controller(tmp_path: Path) -> Callable[..., SimulatedController]:
    """Return a function that makes a simulated controller, with the options of SimulatedController; not started yet."""
    require(*missing_tools())
    build_harness()
    return partial(SimulatedController, build_firmware(), tmp_path)
