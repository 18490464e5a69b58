"""Sketches whose steps are made by a timer: each edge of the pins against the ramp, while loop() does other things and
Arduino's own interrupts come in between."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from firmware.arduino.timed import BUSY, ENGINES, MARK, MARK_MS, SPEEDS, UNTIL_REST, Played, move_all, run, source_of
from firmware.checker import CYCLES_PER_S, CYCLES_PER_US, assert_good, axis_of, lateness_us
from firmware.engine.jobs import Engine
from firmware.rig import RampDesign, image

pytestmark = pytest.mark.usefixtures("arduino_tools")

LATE_US = {1: 12, 2: 30, 3: 50, 4: 50}
BEHIND_OTHERS_US = 12
"""Timer1's interrupts go before Timer0's and the serial port's, those of Timer3, 4 and 5 behind: then steps are later by so
much. Most of the rest is where several axes load a segment at the same instant."""


@pytest.fixture(params=ENGINES, ids=lambda engine: engine.name)
def engine(request: pytest.FixtureRequest) -> Engine:
    """Return each timer of each chip that is tried."""
    chosen: Engine = request.param
    return chosen


def check_axes(played: Played, plan: RampDesign, steps: list[int], late_us: float) -> float:
    """Each axis keeps to its plan and to its design; return how late the latest step is [us]."""
    latest = 0.0
    for axis, count in enumerate(steps):
        made = axis_of(played.edges, axis).steps
        latest = max(latest, float(lateness_us(made, plan.ramp.intervals(abs(count)), plan.cycles_per_tick).max()))
        assert latest <= late_us
        assert_good(played.edges, plan.limits(count, late_us=late_us), axis)
    return latest


def check_millis(played: Played) -> None:
    """millis() goes as the crystal does."""
    marks = played.edges["cycle"][played.edges["pin"] == MARK] / (1000 * CYCLES_PER_US)
    assert marks.size > 20
    late = marks - marks[0] - MARK_MS * np.arange(marks.size)
    assert late.max() - late.min() <= MARK_MS


@pytest.mark.parametrize("count", SPEEDS)
def test_axes_at_their_highest_speed(
    tmp_path: Path, engine: Engine, record_property: Callable[..., None], count: int
) -> None:
    """With the serial port busy, up to three axes both ways: no step is lost, and none later than stated."""
    plan = RampDesign(SPEEDS[count], 30 * SPEEDS[count], 40 * SPEEDS[count])
    steps = [(-1) ** axis * (SPEEDS[count] // 5 + 200 * axis) for axis in range(count)]
    source = source_of(engine, image([plan] * count), move_all(steps), BUSY + UNTIL_REST, axes=count)
    played = run(engine, source, tmp_path, busy=count < len(SPEEDS))
    late_us = LATE_US[count] + (0 if engine.timer == 1 else BEHIND_OTHERS_US)
    record_property("late_us", check_axes(played, plan, steps, late_us))
    check_millis(played)
    assert played.statistics["lost_bytes"] == 0
    # The line carries 11,520 bytes/s.
    assert played.statistics["sent_bytes"] > 5000 * played.statistics["cycles"] / CYCLES_PER_S
