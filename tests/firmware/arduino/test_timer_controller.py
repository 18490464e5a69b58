"""The Controller example with a timer: all that the stand-alone controller does, at the speeds that a timer makes."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from firmware.arduino.board import LIBRARY, MEGA, UNO, build_sketch
from firmware.arduino.timed import SPEEDS
from firmware.checker import CYCLES_PER_US, assert_good, axis_of, lateness_us
from firmware.engine.jobs import Engine
from firmware.protocol import LINE, MOVE_BY, REPORT, STORED, Client, Settings, for_axes, values_of
from firmware.rig import RampDesign, image
from firmware.test_formula_moves import image_of_formula
from ramp.test_on_chip import slopes
from simulator.avr import SimulatedController
from stepramp.ramp.on_chip import OnChipRamp

pytestmark = pytest.mark.usefixtures("arduino_tools")

LATE_US = 60
"""Of steps, with 50 reports a second, which are long messages."""
LINE_SPEEDS = {2: 66_666, 3: 57_142, 4: 50_000}
FORMULA_SPEED = 5000


@pytest.fixture(params=[Engine(UNO), Engine(MEGA, 3)], ids=lambda engine: engine.name)
def engine(request: pytest.FixtureRequest) -> Engine:
    chosen: Engine = request.param
    return chosen


@pytest.fixture
def simulated(tmp_path: Path, engine: Engine) -> Iterator[SimulatedController]:
    """Yield a board that runs the Controller example with a timer, in real time."""
    text = (LIBRARY / "examples" / "Controller" / "Controller.ino").read_text()
    source = tmp_path / f"Controller-{engine.name}.ino"
    source.write_text(f"#include <StepRampTimer{engine.timer}.h>\n{text}")
    assert engine.board is not None
    with SimulatedController(build_sketch(source, engine.board).elf, tmp_path, chip=engine.chip) as running:
        yield running


def check(simulated: SimulatedController, plan: RampDesign, steps: int, axis: int) -> None:
    edges = simulated.edges()
    made = axis_of(edges, axis).steps
    assert lateness_us(made, plan.ramp.intervals(abs(steps)), plan.cycles_per_tick).max() <= LATE_US
    assert_good(edges, plan.limits(steps, late_us=LATE_US), axis)


def test_it_tells_what_a_timer_makes(simulated: SimulatedController, engine: Engine) -> None:
    with Client(simulated.port) as client:
        hello = client.hello_until_answered()
    assert hello.shortest == (160, 320, 480, 640)
    assert hello.shortest_line == (240, 280, 320)
    assert (hello.shortest_formula, hello.largest_image) == ((65535, 256) if engine.board == UNO else (3200, 440))


@pytest.mark.parametrize("count", SPEEDS)
def test_axes_at_their_highest_speed_with_reports(simulated: SimulatedController, count: int) -> None:
    plan = RampDesign(SPEEDS[count], 10 * SPEEDS[count], 10 * SPEEDS[count])
    steps = {axis: (-1) ** axis * SPEEDS[count] // 3 for axis in range(count)}
    with Client(simulated.port) as client:
        client.hello_until_answered()
        client.try_out(image([plan] * count))
        client.expect_ok(REPORT, b"\x32")
        client.expect_ok(MOVE_BY, for_axes(steps))
        status = client.wait_until_idle()
    simulated.stop()
    assert status.starved == 0
    assert simulated.statistics["untouched_stack_bytes"] > 60
    for axis in range(count):
        check(simulated, plan, steps[axis], axis)


@pytest.mark.parametrize("count", LINE_SPEEDS)
def test_lines_at_their_highest_speed(simulated: SimulatedController, count: int) -> None:
    plan = RampDesign(LINE_SPEEDS[count], 20 * LINE_SPEEDS[count], 20 * LINE_SPEEDS[count])
    steps = dict(enumerate([20_000, -14_811, 9233, -97][:count]))
    with Client(simulated.port) as client:
        client.hello_until_answered()
        client.try_out(image([plan] * count))
        client.expect_ok(LINE, bytes([(1 << count) - 1, 0]) + values_of(steps))
        status = client.wait_until_idle()
        assert [client.status(axis).position for axis in range(count)] == list(steps.values())
    simulated.stop()
    assert status.starved == 0
    check(simulated, plan, steps[0], 0)
    assert [axis_of(simulated.edges(), axis).travel for axis in range(count)] == list(steps.values())


def test_a_ramp_is_kept_and_gauges_move(simulated: SimulatedController) -> None:
    plan = RampDesign(2000, 20_000, 20_000, hz=2_000_000)
    with Client(simulated.port) as client:
        client.hello_until_answered()
        client.write_settings(Settings(outputs=1))
        client.push(plan.ramp)
        assert client.read(STORED) == plan.ramp.image()
        client.move_by(301)
        assert client.wait_until_idle().position == 301
    simulated.stop()
    edges = simulated.edges()
    # The Controller example has no coils: its gauges are counted, and no stepper's pin moves.
    assert not np.isin(edges["pin"], (2, 3, 4, 12)).any()


def test_formulas_on_a_mega(simulated: SimulatedController, engine: Engine) -> None:
    if engine.board == UNO:
        pytest.skip("an Uno with Arduino's core has no room for formulas")
    ramp = OnChipRamp.of(*slopes(16e6, FORMULA_SPEED, 0, 300, 1), "newton")
    with Client(simulated.port) as client:
        client.hello_until_answered()
        client.try_out(image_of_formula(ramp, fast=True))
        client.expect_ok(REPORT, b"\x32")
        client.move_by(1500)
        status = client.wait_until_idle()
    simulated.stop()
    assert (status.starved, status.position) == (0, 1500)
    made = axis_of(simulated.edges()).steps
    assert lateness_us(made, ramp.move(1500), 1).max() <= LATE_US
    assert made.size == 1500
    assert np.diff(made).min() > 3200 - LATE_US * CYCLES_PER_US
