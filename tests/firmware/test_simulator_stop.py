"""Stop and halt on the simulated chip, at full speed and with a ramp that is hard work."""

import time
from collections.abc import Callable

import numpy as np
import pytest

from firmware.protocol import HALT, IN_MOTION, STOP, Client, Ramp, expand
from firmware.test_player import stopped_moves
from firmware.test_simulator_moves import LEAD_SCREW, LONGEST_INTERRUPT_CYCLES, check_pins, fast, ticks_of
from simulator.avr import CLOCK_HZ, SimulatedController, pulses

Make = Callable[..., SimulatedController]
ANSWER_WITHIN_S = 0.010
SECONDS_ON_THE_LINE = 20 * 10 / 115_200
"""Of a stop and its answer."""


def asked_at(client: Client, kind: int, steps_made: int) -> None:
    """Ask for something as soon as a move has made so many steps."""
    while client.status().steps_made < steps_made:
        pass
    client.expect_ok(kind)


def stopped(make: Make, ramp: Ramp, steps: int, at_step: int) -> list[int]:
    """Play a move that is stopped; return its intervals [ticks], the last one not, since nothing ends it."""
    with make() as simulated, Client(simulated.port) as client:
        client.hello()
        client.push(ramp)
        client.move_by(steps)
        asked_at(client, STOP, at_step)
        client.expect_ok(STOP)
        status = client.wait_until_idle()
    check_pins(simulated.edges())
    rises = pulses(simulated.edges())
    assert status.position == status.target == status.steps_made == len(rises)
    assert simulated.statistics["longest_interrupt_cycles"] < LONGEST_INTERRUPT_CYCLES
    return [int(interval) for interval in np.diff(ticks_of(rises))]


def check_is_the_beginning_of_a_stop(made: list[int], ramp: Ramp, steps: int) -> None:
    """The planned intervals, then perhaps the last of them held, then the way down, whose last interval isn't made."""
    plan = ramp.intervals(steps)
    same = next((i for i, (ours, own) in enumerate(zip(made, plan, strict=False)) if ours != own), len(made))
    accelerates = same <= len(expand(ramp.up))
    held = plan[same - 1] if accelerates else ramp.slew
    way = [interval for interval in expand(ramp.down) if not accelerates or interval > held]
    expected = [*plan[:same], *[held] * (len(made) + 1 - same - len(way)), *way[::-1]]
    assert made == expected[: len(made)]


@pytest.mark.parametrize("at_step", [1, 40, 200, 290, 302, 320, 700, 1960])
def test_stop_anywhere(simulated_controller: Make, at_step: int) -> None:
    made = stopped(simulated_controller, LEAD_SCREW, 2000, at_step)
    assert len(made) < 1999 or at_step == 1960
    check_is_the_beginning_of_a_stop(made, LEAD_SCREW, 2000)


@pytest.mark.parametrize(
    ("at_step", "segments", "count"), [(50, 60, 30), (1000, 60, 30), (50, 60, 1), (10_000, 60, 30)]
)
def test_stop_at_20_us_with_many_segments(simulated_controller: Make, at_step: int, segments: int, count: int) -> None:
    ramp = fast(segments, count)
    made = stopped(simulated_controller, ramp, 400_000, at_step)
    assert len(made) < 399_999
    check_is_the_beginning_of_a_stop(made, ramp, 400_000)


def test_stop_in_a_long_interval(simulated_controller: Make) -> None:
    ramp = Ramp([(400_000, 20, -10_000)], 100_000, [(400_000, 20, -10_000)])
    made = stopped(simulated_controller, ramp, 100, 3)
    assert any(made == whole[:-1] for whole in stopped_moves(ramp, 100, 2, 25))


@pytest.mark.parametrize("kind", [STOP, HALT])
def test_answers_come_in_10_ms_at_full_speed(
    simulated_controller: Make, record_property: Callable[..., None], kind: int
) -> None:
    """At 20 µs a step the interrupt leaves little time. The ramp is written before, as checking it takes longer."""
    with simulated_controller(real_time=False) as simulated, Client(simulated.port) as client:
        client.hello()
        client.push(fast(60, 1))
    with simulated, Client(simulated.port) as client:
        client.hello()
        client.move_by(2_000_000)
        for _ in range(20):
            assert client.status().state == IN_MOTION
        client.expect_ok(kind)
        status = client.wait_until_idle()
    longest_s = simulated.statistics["longest_answer_cycles"] / CLOCK_HZ
    record_property("longest_answer_ms", longest_s * 1e3)
    assert longest_s + SECONDS_ON_THE_LINE < ANSWER_WITHIN_S
    assert simulated.statistics["lost_bytes"] == 0
    assert status.position == len(pulses(simulated.edges()))


def test_halt_stops_at_once(simulated_controller: Make) -> None:
    with simulated_controller() as simulated, Client(simulated.port) as client:
        client.hello()
        client.push(fast(20, 4))
        client.move_by(-200_000)
        asked_at(client, HALT, 1000)
        status = client.status()
        time.sleep(0.05)
        assert client.status() == status
        client.move_to(0)
        assert client.wait_until_idle().position == 0
    edges = simulated.edges()
    assert len(pulses(edges)) == -2 * status.position
    check_pins(edges)
