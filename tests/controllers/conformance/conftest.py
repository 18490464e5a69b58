"""What docs/serial_protocol.md demands of every controller: the virtual one, and the firmware in the simulator.

What a controller does with a change in flight depends on the instant at which it decides; so positions, targets and
final states are compared then, not instants.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from controllers.protocol_line import Line
from simulator.avr import SimulatedController, build_firmware, missing_tools
from stepramp.controllers.virtual.controller import VirtualController
from tools import require


@pytest.fixture(params=["virtual", "firmware"])
def port(request: pytest.FixtureRequest, tmp_path: Path, plug_in: Callable) -> Iterator[str]:
    if request.param == "virtual":
        yield plug_in(VirtualController())
        return
    require(*missing_tools())
    with SimulatedController(build_firmware(), tmp_path) as controller:
        yield controller.port


@pytest.fixture
def line(port: str) -> Iterator[Line]:
    line = Line(port)
    yield line
    line.port.close()
