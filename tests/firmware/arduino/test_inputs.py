"""Inputs of sketches, in the simulator: how soon an emergency stop is obeyed, and what the examples with inputs do."""

import re
import struct
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from firmware.arduino.board import LEONARDO, LIBRARY, MEGA, UNO, build, build_sketch
from firmware.arduino.pins import after_s, edges_until, moves_of, times_us
from firmware.arduino.stops import PINS, Stop
from firmware.arduino.timed import UNTIL_REST, run, source_of
from firmware.engine.jobs import Engine
from firmware.protocol import (
    ACKNOWLEDGE,
    AT_LIMIT,
    BY_EMERGENCY_STOP,
    EMERGENCY_STOP,
    HELLO,
    HOME,
    LOW_LIMIT,
    RUN,
    STATUS,
    STOPPED,
    WRITE_SETTINGS,
    Client,
    InputSettings,
    InputsStatus,
    Settings,
    for_axes,
    values_of,
)
from firmware.rig import RampDesign, image
from simulator.avr import Chip, SimulatedController

pytestmark = pytest.mark.usefixtures("arduino_tools")

MOST_US = 100
"""From the edge of the emergency stop to the last step, where a timer makes the steps."""
MOST_POLLED_US = 1000
"""Where poll() does: as long as a round of an Uno's takes at most."""
MOST_LOOKED_US = 15_000
"""Where a timer makes the steps, and only poll() sees the pin: in four looks, 1 ms or a round of loop() apart."""
FORMULAS, GAUGES, INPUTS, KEEPS, SOFT_LIMITS = 1, 2, 4, 8, 16
OUTPUT_STATUS_BYTES = 26
STEP, DIRECTION = 2, 5
PIN_CHANGE = "\n#include <StepRampPinChange.h>"


@pytest.mark.parametrize(
    "stop",
    [
        Stop(Engine(UNO), 1),
        Stop(Engine(UNO), 4),
        Stop(Engine(UNO), 4, width_us=100),
        Stop(Engine(UNO), 4, pin=15, header=PIN_CHANGE),
        Stop(Engine(MEGA, 5), 4),
        Stop(Engine(MEGA, 3), 4, pin=50, header=PIN_CHANGE),
        Stop(Engine(LEONARDO, 3), 4),
        Stop(Engine(UNO), 1, timer=False),
        Stop(Engine(UNO), 4, timer=False),
    ],
    ids=lambda stop: f"{stop.engine.name if stop.timer else 'loop'} {stop.axes} axes at {stop.pin} {stop.width_us} us",
)
def test_an_emergency_stop_halts_all(tmp_path: Path, record_property: Callable[..., None], stop: Stop) -> None:
    """At the highest speeds, with the serial port busy; each time it is acknowledged the motors set out again."""
    latest = stop.latest_us(tmp_path)
    record_property("latest_us", latest)
    assert latest <= (MOST_US if stop.timer else MOST_POLLED_US)


@pytest.mark.parametrize("axes", [3, 4])
def test_an_emergency_stop_at_a_pin_without_an_interrupt_waits_for_its_looks(
    tmp_path: Path, record_property: Callable[..., None], axes: int
) -> None:
    latest = Stop(Engine(MEGA, 4), axes, pin=30, pressed_ms=17).latest_us(tmp_path)
    record_property("latest_us", latest)
    assert MOST_US < latest <= MOST_LOOKED_US


@pytest.mark.parametrize("input", ["setEmergencyStop(30)", "setEmergencyStop(2)", "setLowLimit(0, 30)"])
@pytest.mark.parametrize("looks", [1, 4, 10])
def test_what_is_active_as_begin_returns_lets_nothing_move(tmp_path: Path, input: str, looks: int) -> None:
    """The first motion is asked for at once. Where the switch is open, it is granted."""
    engine, ramps = Engine(MEGA, 4), image([RampDesign(1000, 20_000, 20_000)])
    tell = (
        "PORT.write(StepRamp.stoppedBy()); PORT.write(StepRamp.isAtLimit(0));"
        "PORT.write(StepRamp.moveBy(0, -20)); PORT.write(StepRamp.isMoving());"
    )
    settings = f"StepRamp.setInputLooks({looks}); StepRamp.{input};"
    source = source_of(engine, ramps, tell, UNTIL_REST, axes=1, settings=settings, pins=PINS)
    pin = re.findall(r"\d+", input)[-1]
    held = run(engine, source, tmp_path, "--press", f"{pin}:0-3000", busy=False)
    assert list(held.sent) == ([BY_EMERGENCY_STOP, 0, STOPPED, 0] if "Stop" in input else [0, 1, AT_LIMIT, 0])
    free = run(engine, source, tmp_path, busy=False)
    assert list(free.sent) == [0, 0, 0, 1]
    pulses = [
        np.count_nonzero((edges["pin"] == PINS[0][0]) & (edges["value"] == 1)) for edges in (held.edges, free.edges)
    ]
    assert pulses == [0, 20]


@pytest.mark.parametrize("board", [UNO, MEGA], ids=lambda board: board.name)
def test_a_sketch_without_an_emergency_stop_keeps_its_interrupts(tmp_path: Path, board: object) -> None:
    source = tmp_path / "keeps.ino"
    source.write_text(
        "#include <StepRampAxis.h>\n#include <StepRampTimer1.h>\n"
        "ISR(INT0_vect) {}\nISR(PCINT0_vect) {}\nStepRampAxis x(2, 5);\n"
        "void setup() { x.setLimitSwitches(9); x.begin(); }\nvoid loop() { x.run(); }\n"
    )
    assert build_sketch(source, board).warnings == ""


def test_homing_comes_to_the_same_step_each_time(tmp_path: Path) -> None:
    switch_at = -120
    simulated = SimulatedController(
        build("Homing").elf, tmp_path, real_time=False, surroundings=["--switch", f"9:0<{switch_at}"]
    )
    edges = edges_until(simulated, after_s(15))
    # The last may be cut off by the end of what was recorded.
    moves = moves_of(edges, STEP, DIRECTION, rest_us=200_000)[:-1]
    at, places = 0, []
    for move in moves:
        at += -len(move.times_us) if move.backward else len(move.times_us)
        if not move.backward and len(move.times_us) > 380:
            places.append(at - 400)
    assert len(places) >= 4
    # It is inactive at -119. The example goes to its place 400 from there.
    assert set(places) <= {switch_at + 1, switch_at + 2}
    assert max(places) - min(places) <= 1


@pytest.mark.parametrize("timer", [False, True])
def test_after_an_emergency_stop_nothing_moves_until_it_is_acknowledged(tmp_path: Path, timer: bool) -> None:
    text = (LIBRARY / "examples" / "EmergencyStop" / "EmergencyStop.ino").read_text()
    source = tmp_path / f"EmergencyStop-{timer}.ino"
    source.write_text(text.replace("// #include", "#include") if timer else text)
    # Its switch opens when it is pressed, from 1400 to 1700 ms; acknowledged in vain at 1500, and at 2000.
    presses = "2:0-1400,2:1700-9000,14:1500-1550,14:2000-2050"
    simulated = SimulatedController(
        build_sketch(source).elf, tmp_path, real_time=False, surroundings=["--press", presses]
    )
    edges = edges_until(simulated, after_s(4))
    steps = times_us(edges, 4, 1) / 1000
    assert ((steps > 1390) & (steps < 1400)).any()
    [(last, first)] = [(a, b) for a, b in pairwise(steps) if b - a > 300]
    assert last <= 1400.2
    assert 2000 < first < 2020
    # Where it is stays known: it goes on to its goal and comes back.
    moves = moves_of(edges, 4, 7, rest_us=1e9)
    assert [(move.backward, len(move.times_us)) for move in moves[:2]] == [(False, 800), (True, 800)]


def test_a_stop_in_flight_ends_with_the_ramp(tmp_path: Path) -> None:
    simulated = SimulatedController(build("StopInFlight").elf, tmp_path, real_time=False, press=(14, 1500, 2500))
    edges = edges_until(simulated, after_s(3.5))
    first, second = moves_of(edges, STEP, DIRECTION, rest_us=400_000)[:2]
    assert (first.backward, second.backward) == (False, True)
    # 900 steps/s at 4000 steps/s²: some 101 steps, once what is queued has been played.
    after = first.times_us[first.times_us > 1_500_000]
    assert 100 <= after.size <= 120
    down = np.diff(after[-90:])
    planned = np.diff(np.sqrt(2 * np.arange(91)[::-1] / 4000)) * -1e6
    assert np.abs(down.sum() - planned[:89].sum()) < 0.1 * planned.sum()
    assert down[-1] > 4 * down[0]


def test_a_megas_controller_has_formulas_gauges_and_inputs(tmp_path: Path) -> None:
    """As hello tells; inputs do what they do on the stand-alone controller."""
    text = (LIBRARY / "examples" / "Controller" / "Controller.ino").read_text()
    source = tmp_path / "Controller-inputs.ino"
    source.write_text(f"#include <StepRampTimer4.h>\n{text}")
    sketch = build_sketch(source, MEGA)
    plan = RampDesign(8000, 40_000, 40_000)
    home = struct.pack("<BIH", 1, 16_000_000 // 500, 30) + values_of({0: -8 * plan.slew})
    surroundings = ["--press", "18:2500-4000", "--switch", "63:0<-250"]
    with (
        SimulatedController(sketch.elf, tmp_path, chip=Chip("atmega2560", 4), surroundings=surroundings) as simulated,
        Client(simulated.port) as client,
    ):
        client.hello_until_answered()
        hello = client.expect_ok(HELLO, b"\3")
        assert list(hello[44:]) == [FORMULAS | GAUGES | INPUTS | KEEPS | SOFT_LIMITS, 24, 32]
        roles = {0: EMERGENCY_STOP, 5: LOW_LIMIT}
        client.expect_ok(WRITE_SETTINGS, Settings().packed() + InputSettings(roles=roles).packed())
        client.try_out(image([plan]))
        client.expect_ok(HOME, home)
        inputs = inputs_of(client)
        while inputs.homing:
            inputs = inputs_of(client)
        assert inputs.known & 1 == 1
        client.expect_ok(RUN, for_axes({0: plan.slew}))
        while not inputs_of(client).stopped_by:
            pass
        assert inputs_of(client).stopped_by == BY_EMERGENCY_STOP
        assert client.request(RUN, for_axes({0: plan.slew}))[0] == STOPPED
        while client.request(ACKNOWLEDGE)[0] == STOPPED:
            pass
        assert inputs_of(client).stopped_by == 0
    steps = times_us(simulated.edges(), STEP, 1) / 1000
    assert ((steps > 2490) & (steps < 2500)).any()
    assert not (steps > 2500.1).any()


def inputs_of(client: Client) -> InputsStatus:
    return InputsStatus.unpack(client.expect_ok(STATUS, b"\0")[OUTPUT_STATUS_BYTES:])
