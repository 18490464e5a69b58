"""What docs/serial_protocol.md demands of every controller: the virtual one, and the firmware in the simulator.

What a controller does with a change in flight depends on the instant at which it decides; so positions, targets and
final states are compared then, not instants.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from threading import Lock

import pytest

from controllers.protocol_line import Line
from simulator.avr import SimulatedController, build_firmware, missing_tools
from stepramp.controllers.virtual.controller import VirtualController
from tools import require

LONGEST_LOOK_S = 0.02


class PatientClock:
    """A clock [s] that waits for who looks at it: on a busy machine time goes slowly, and nobody misses anything.

    Where it is always looked at, as by who listens at a virtual port, it goes as the real one does.
    """

    def __init__(self) -> None:
        self._now_s, self._looked_s = 0.0, time.monotonic()
        self._lock = Lock()

    def __call__(self) -> float:
        with self._lock:
            looked_s = time.monotonic()
            self._now_s += min(looked_s - self._looked_s, LONGEST_LOOK_S)
            self._looked_s = looked_s
            return self._now_s


@pytest.fixture(params=["virtual", "firmware"])
def port(request: pytest.FixtureRequest, tmp_path: Path, plug_in: Callable) -> Iterator[str]:
    if request.param == "virtual":
        yield plug_in(VirtualController(PatientClock()))
        return
    require(*missing_tools())
    with SimulatedController(build_firmware(), tmp_path) as controller:
        yield controller.port


@pytest.fixture
def line(port: str) -> Iterator[Line]:
    line = Line(port)
    yield line
    line.port.close()
