"""The Controller example on a simulated Uno: it speaks the protocol, keeps what it is sent, and moves."""

from collections.abc import Callable

import numpy as np
import pytest

from firmware.arduino.pins import MOST_EARLY_US
from firmware.protocol import (
    BAD_RAMP,
    BEGIN,
    DATA,
    END,
    IN_MOTION,
    LINE,
    MOVE_BY,
    REPORT,
    RUN,
    STOP,
    STORED,
    STORED_IN_USE,
    TOO_FAST,
    TRACE,
    Client,
    Ramp,
    Report,
    Settings,
    crc16,
    for_axes,
    image_of,
    image_parts,
    values_of,
    with_header,
)
from simulator.avr import SimulatedController
from stepramp.controllers.stepramp.controller import StepRampController
from stepramp.design import Design
from stepramp.errors import Rejected
from stepramp.link.serial_port import SerialPort

Make = Callable[..., SimulatedController]

RAMP = Ramp([(12_000, 4, -1500), (6000, 20, -200), (2000, 15, -40)], 1200, [(12_000, 4, -1500), (6000, 12, -300)])
FASTEST_TICKS = {1: 800, 2: 1200, 3: 1600, 4: 2000}
"""Shortest intervals when so many axes move [ticks of 0.5 us], as hello tells them."""
LINE_TICKS = {2: 1000, 3: 1100, 4: 1200}
STEP_PINS = (2, 3, 4, 12)
DIRECTION_PINS = (5, 6, 7, 13)
LATE_WITH_REPORTS_US = 1000
"""A round of loop() that makes a report of four axes, and what comes with it."""


def fast(interval: int) -> Ramp:
    return Ramp([(8000, 10, -600), (interval + 600, 30, -20)], interval, [(8000, 10, -600), (interval + 600, 30, -20)])


def rises_us(simulated: SimulatedController, axis: int) -> np.ndarray:
    edges = simulated.edges()
    return edges["cycle"][(edges["pin"] == STEP_PINS[axis]) & (edges["value"] == 1)] / 16


def test_it_tells_what_a_polled_board_can_do(simulated_uno: Make) -> None:
    with simulated_uno("Controller") as simulated, Client(simulated.port) as client:
        hello = client.hello_until_answered()
    assert [interval // 8 for interval in hello.shortest] == list(FASTEST_TICKS.values())
    assert [interval // 8 for interval in hello.shortest_line] == list(LINE_TICKS.values())
    assert (hello.shortest_formula, hello.largest_image, hello.axes) == (0xFFFF, 256, 4)


def test_a_ramp_is_pushed_kept_and_played(simulated_uno: Make) -> None:
    with simulated_uno("Controller") as simulated, Client(simulated.port) as client:
        client.hello_until_answered()
        client.write_settings(Settings(pulse_width_us=10, enable_hold_ms=20))
        client.push(RAMP)
        assert client.read(STORED) == RAMP.image()
    with simulated, Client(simulated.port) as client:
        hello = client.hello_until_answered()
        assert (hello.in_use, hello.crc) == (STORED_IN_USE, crc16(RAMP.image()))
        client.move_by(-300)
        status = client.wait_until_idle()
    assert (status.position, status.steps_made, status.starved) == (-300, 300, 0)
    intervals = np.diff(rises_us(simulated, 0))
    planned = np.array(RAMP.intervals(300)[:-1]) / 2
    assert len(intervals) == 299
    assert (intervals - planned).min() >= -MOST_EARLY_US
    edges = simulated.edges()
    assert edges["value"][edges["pin"] == DIRECTION_PINS[0]][-1] == 0


@pytest.mark.parametrize("axes", FASTEST_TICKS)
def test_its_limits_are_kept(simulated_uno: Make, record_property: Callable[..., None], axes: int) -> None:
    """All axes at the shortest interval, with reports and requests meanwhile."""
    ramp, steps = fast(FASTEST_TICKS[axes]), 800
    with simulated_uno("Controller", real_time=True) as simulated, Client(simulated.port) as client:
        client.hello_until_answered()
        client.try_out(ramp.image(axes))
        client.expect_ok(REPORT, b"\x32")
        client.expect_ok(MOVE_BY, for_axes(dict.fromkeys(range(axes), steps)))
        status = client.wait_until_idle()
        report = Report.unpack(client.read_notice()[4:])
    assert (status.starved, len(report.positions)) == (0, axes)
    assert simulated.statistics["lost_bytes"] == 0
    assert simulated.statistics["untouched_stack_bytes"] > 100
    planned = np.array(ramp.intervals(steps)[:-1]) / 2
    for axis in range(axes):
        late = np.diff(rises_us(simulated, axis)) - planned
        record_property(f"latest_us_{axis}", round(float(late.max())))
        record_property(f"longer_percent_{axis}", round(100 * float(late.sum() / planned.sum()), 1))
        assert late.min() >= -MOST_EARLY_US
        assert late.max() <= LATE_WITH_REPORTS_US
        assert late.sum() <= 0.1 * planned.sum()


@pytest.mark.parametrize("axes", LINE_TICKS)
def test_lines_are_drawn_at_their_limits(simulated_uno: Make, axes: int) -> None:
    ramp, steps = fast(LINE_TICKS[axes]), [700, -481, 233, -97][:axes]
    with simulated_uno("Controller", real_time=True) as simulated, Client(simulated.port) as client:
        client.hello_until_answered()
        client.try_out(ramp.image(axes))
        client.expect_ok(LINE, bytes([(1 << axes) - 1, 0]) + values_of(dict(enumerate(steps))))
        status = client.wait_until_idle()
        assert [client.status(axis).position for axis in range(axes)] == steps
    assert status.starved == 0
    leader = rises_us(simulated, 0)
    assert len(leader) == 700
    assert (np.diff(leader) - np.array(ramp.intervals(700)[:-1]) / 2).min() >= -MOST_EARLY_US
    for axis in range(1, axes):
        own, count = rises_us(simulated, axis), abs(steps[axis])
        with_leader = leader[[-(-700 * (2 * m - 1) // (2 * count)) - 1 for m in range(1, count + 1)]]
        assert np.abs(own - with_leader).max() < 100


def test_it_runs_and_stops(simulated_uno: Make) -> None:
    with simulated_uno("Controller", real_time=True) as simulated, Client(simulated.port) as client:
        client.hello_until_answered()
        client.try_out(RAMP)
        client.expect_ok(TRACE, b"\0\0\0")
        client.expect_ok(RUN, for_axes({0: -2000}))
        while client.status().steps_made < 200:
            pass
        client.expect_ok(STOP)
        status = client.wait_until_idle()
    rises = rises_us(simulated, 0)
    assert status.position == -len(rises)
    assert np.abs(np.median(np.diff(rises)) - 1000) < 50


def test_what_is_too_fast_for_it_is_refused(simulated_uno: Make) -> None:
    with simulated_uno("Controller") as simulated, Client(simulated.port) as client:
        client.hello_until_answered()
        for image in (fast(799).image(), image_of([with_header(1, bytes(95))])):
            client.expect_ok(BEGIN, len(image).to_bytes(2, "little") + crc16(image).to_bytes(2, "little"))
            for part in image_parts(image):
                client.expect_ok(DATA, part)
            assert client.request(END)[0] == BAD_RAMP
        client.try_out(fast(800).image(2))
        assert client.request(MOVE_BY, for_axes({0: 100, 1: 100}))[0] == TOO_FAST
        client.move_by(100)
        assert client.status().state == IN_MOTION
        client.wait_until_idle()
    assert len(rises_us(simulated, 0)) == 100


def test_the_program_pushes_its_designs_to_it(simulated_uno: Make) -> None:
    """What is by formula elsewhere is sent as segments; what is too fast is refused with the board's own limit."""
    timer = {"frequency_hz": 2_000_000, "counter_bits": 32}
    newton = {"name": "newton", "arithmetic": "fixed"}
    with simulated_uno("Controller", real_time=True) as simulated:
        controller = StepRampController(SerialPort(simulated.port))
        controller.connect()
        for speed in (900, 3000):
            ramp = {"slew_speed_steps_per_s": speed, "acceleration_steps_per_s2": 3000}
            document = {"schema": "stepramp/1", "timer": timer, "ramp": ramp, "method": newton, "move": {"steps": 400}}
            design = Design.model_validate(document)
            if speed == 900:
                report = controller.prepare_push([design])()
                assert report.verified
                assert report.segments > 0
            else:
                with pytest.raises(Rejected, match="to 2,500 steps/s with this controller"):
                    controller.prepare_push([design])
        controller.disconnect()


def test_nothing_moves_unasked(simulated_uno: Make) -> None:
    with simulated_uno("Controller") as simulated, Client(simulated.port) as client:
        client.hello_until_answered()
        client.push(RAMP)
        simulated.press_reset()
        client.hello_until_answered()
    edges = simulated.edges()
    assert not np.isin(edges["pin"], STEP_PINS).any()
