"""The firmware on a simulated ATmega328P: when its step pin really rises."""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest

from firmware.protocol import Client, Ramp, expand
from simulator.avr import DIRECTION_PIN, STEP_PIN, SimulatedController, pulses

CYCLES_PER_TICK = 8
TICK_US = 0.5
LONGEST_INTERRUPT_CYCLES = 310
"""Of 320 at the shortest interval: it must be over before the next one, and leave the main loop some time."""
Make = Callable[..., SimulatedController]

LEAD_SCREW = Ramp(
    [(20_000, 1, 0), (14_142, 2, -2595), (10_000, 300, -20)], 2000, [(20_000, 2, -5858), (11_547, 40, -200)]
)


def fast(segments: int, count: int) -> Ramp:
    """Return a ramp to the shortest interval, 20 µs, that makes as much work as its segments can."""
    add = -1 if count > 1 else 0
    up = [(40 + (segments - i) * count, count, add) for i in range(segments)]
    return Ramp(up, 40, [(interval + 1, count, add) for interval, count, add in up])


def deviations_us(edges: npt.NDArray[np.void], expected_ticks: list[int]) -> npt.NDArray[np.float64]:
    """Return each interval between pulses less the expected one [µs]; there must be as many pulses as intervals."""
    rises = pulses(edges)
    assert len(rises) == len(expected_ticks)
    return (np.diff(rises) / CYCLES_PER_TICK - expected_ticks[:-1]) * TICK_US


def ticks_of(rises: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Return the timer ticks at which pulses begin, counted from anywhere.

    Most begin at the earliest place in their tick or just after it. A few have to wait longer until an instruction is
    over, so that they may seem to be in the next tick: only a place that is common counts as the earliest.
    """
    common = np.bincount(rises % CYCLES_PER_TICK, minlength=CYCLES_PER_TICK) > len(rises) / 20
    earliest = next(place for place in range(CYCLES_PER_TICK) if common[place] and not common[place - 1])
    return (rises - earliest) // CYCLES_PER_TICK


def check_pins(edges: npt.NDArray[np.void]) -> None:
    """Each pulse is long enough; the direction is set 20 µs before the first pulse and then keeps still."""
    step = edges[edges["pin"] == STEP_PIN]
    assert (np.diff(step["cycle"])[::2] >= 3 * 16).all()
    for change in edges[edges["pin"] == DIRECTION_PIN]:
        after = step["cycle"][step["cycle"] > change["cycle"]]
        before = step["cycle"][step["cycle"] < change["cycle"]]
        assert len(after) == 0 or after[0] - change["cycle"] >= 20 * 16
        assert len(before) == 0 or change["cycle"] - before[-1] >= 20 * 16


@pytest.mark.parametrize(
    ("ramp", "steps"),
    [
        pytest.param(LEAD_SCREW, 2000, id="lead screw"),
        pytest.param(LEAD_SCREW, 150, id="triangle"),
        pytest.param(LEAD_SCREW, 345, id="exactly both lists"),
        pytest.param(LEAD_SCREW, 1, id="one step"),
        pytest.param(LEAD_SCREW, 2, id="two steps"),
        pytest.param(fast(20, 4), 20_000, id="20 us slew"),
        pytest.param(fast(60, 1), 1000, id="segments of one step at 20 us"),
        pytest.param(Ramp([], 40, []), 5000, id="no lists"),
        pytest.param(Ramp([(3000, 20, -100)], 1000, []), 100, id="only up"),
        pytest.param(Ramp([], 1000, [(3000, 20, -100)]), 100, id="only down"),
        pytest.param(
            Ramp([(300_000, 5, -30_000), (65_537, 4, -1)], 65_536, [(70_000, 9, -3)]), 25, id="more than 65535 ticks"
        ),
        pytest.param(Ramp([(100, 2, -1)], 60, [(100, 2, -1)]), 70_000, id="slew of more than 65535 steps"),
    ],
)
def test_every_interval_is_the_planned_one(
    simulated_controller: Make, record_property: Callable[..., None], ramp: Ramp, steps: int
) -> None:
    with simulated_controller(real_time=False) as simulated, Client(simulated.port) as client:
        client.hello()
        client.push(ramp)
        client.move_by(steps)
        status = client.wait_until_idle()
    assert (status.position, status.target, status.steps_made, status.interval) == (steps, steps, steps, 0)
    edges = simulated.edges()
    largest_us = np.abs(deviations_us(edges, ramp.intervals(steps))).max(initial=0.0)
    cycles = simulated.statistics["longest_interrupt_cycles"]
    record_property("largest_deviation_us", largest_us)
    record_property("longest_interrupt_cycles", cycles)
    assert largest_us <= TICK_US
    assert cycles < LONGEST_INTERRUPT_CYCLES
    check_pins(edges)


def test_there_and_back(simulated_controller: Make) -> None:
    with simulated_controller(real_time=False) as simulated, Client(simulated.port) as client:
        client.hello()
        client.push(LEAD_SCREW)
        for target in (500, -300, -300, 0, 1):
            client.move_to(target)
            assert client.wait_until_idle().position == target
    edges = simulated.edges()
    check_pins(edges)
    assert len(pulses(edges)) == 500 + 800 + 300 + 1
    step_or_direction = edges[(edges["value"] == 1) | (edges["pin"] == DIRECTION_PIN)]
    position, forward = 0, False
    for edge in step_or_direction:
        if edge["pin"] == DIRECTION_PIN:
            forward = edge["value"] == 1
        else:
            position += 1 if forward else -1
    assert position == 1


def test_nothing_moves_unasked(simulated_controller: Make) -> None:
    """Neither at start, nor at hello, nor when a ramp is written, nor at a reset."""
    with simulated_controller(real_time=False) as simulated, Client(simulated.port) as client:
        client.hello()
        client.push(LEAD_SCREW)
        client.push(fast(20, 4))
        simulated.press_reset()
        client.hello_until_answered()
        assert client.status().position == 0
    assert len(simulated.edges()) == 0


def test_status_while_moving_tells_the_present_interval(simulated_controller: Make) -> None:
    with simulated_controller() as simulated, Client(simulated.port) as client:
        client.hello()
        client.push(LEAD_SCREW)
        client.move_by(-1000)
        plan = LEAD_SCREW.intervals(1000)
        seen = 0
        while (status := client.status()).state:
            assert status.position == -status.steps_made
            assert status.target == -1000
            around = plan[max(status.steps_made - 2, 0) : status.steps_made + 1]
            assert status.interval in around
            seen += 1
        assert seen > 10
        assert len(expand(LEAD_SCREW.up)) == 303
