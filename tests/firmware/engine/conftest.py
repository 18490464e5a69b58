import shutil

import pytest

from firmware.arduino.board import missing
from firmware.engine.jobs import CONTROLLER, IN_SKETCHES, Engine
from simulator.avr import missing_tools
from tools import require


@pytest.fixture(autouse=True)
def _tools() -> None:
    require(*missing_tools(), *([] if shutil.which("gcc") else ["gcc"]))


@pytest.fixture(params=[CONTROLLER, *IN_SKETCHES], ids=lambda engine: engine.name)
def engine(request: pytest.FixtureRequest) -> Engine:
    """Return each engine in turn."""
    chosen: Engine = request.param
    require(*(missing() if chosen.board else []))
    return chosen
