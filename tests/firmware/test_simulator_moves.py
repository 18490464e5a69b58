"""The firmware on a simulated ATmega328P: when the step pin of one axis really rises, from rest to rest."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from firmware.checker import CYCLES_PER_US, assert_good, lateness_us
from firmware.protocol import HALT, SLOW_HZ, Client, Ramp
from firmware.rig import BusyClient, Make, RampDesign, at_the_same_time, controller_in, image, move_by, play, until_made

LATE_US, LATE_AT_SPEED_US = 2.0, 5.0
"""Below 50,000 steps/s, and above."""
PLANS = {
    "lead screw": RampDesign(10_000, 100_000, 50_000, SLOW_HZ),
    "fast clock": RampDesign(10_000, 100_000, 50_000),
    "49,000": RampDesign(49_000, 2_000_000, 1_500_000),
    "130,000": RampDesign(130_000, 6_000_000, 6_000_000),
    "150,000": RampDesign(150_944, 8_000_000, 10_000_000),
}
WHOLE = {"lead screw": 2500, "fast clock": 2500, "49,000": 4000, "130,000": 12_000, "150,000": 30_000}
Record = Callable[..., None]


@pytest.mark.parametrize("name", PLANS)
@pytest.mark.parametrize("sign", [1, -1])
def test_a_move_is_as_planned_and_as_designed(
    simulated_controller: Make, record_property: Record, name: str, sign: int
) -> None:
    """Up, at slew speed and down, while the serial port is busy: no step is lost, early or late."""
    plan, steps = PLANS[name], sign * WHOLE[name]
    played = play(simulated_controller, image([plan]), move_by(steps))
    late = lateness_us(played.steps(), plan.ramp.intervals(abs(steps)), plan.cycles_per_tick)
    record_property("late_us", float(late.max()))
    played.assert_nothing_lost()
    allowed = LATE_US if plan.speed < 50_000 else LATE_AT_SPEED_US
    assert late.max() <= allowed + plan.cycles_per_tick / CYCLES_PER_US
    assert_good(played.edges, plan.limits(steps, late_us=allowed))


@pytest.mark.parametrize("name", ["lead screw", "fast clock"])
@pytest.mark.parametrize("steps", [1, 2, 3, 150])
def test_a_move_too_short_for_its_ramp(simulated_controller: Make, name: str, steps: int) -> None:
    plan = PLANS[name]
    played = play(simulated_controller, image([plan]), move_by(steps))
    late = lateness_us(played.steps(), plan.ramp.intervals(steps), plan.cycles_per_tick)
    assert late.max() <= LATE_US + plan.cycles_per_tick / CYCLES_PER_US
    assert_good(played.edges, plan.limits(steps))
    played.assert_nothing_lost()


UNEVEN = {
    "no lists": (Ramp([], 300, []), 500),
    "only up": (Ramp([(3000, 20, -100)], 1000, []), 100),
    "only down": (Ramp([], 1000, [(3000, 20, -100)]), 100),
    "segments of one step": (Ramp([(5000 - 40 * i, 1, 0) for i in range(40)], 3000, [(6000, 1, 0)]), 400),
    "longer than 16 bits": (Ramp([(300_000, 5, -30_000), (65_537, 4, -1)], 65_536, [(70_000, 9, -3)]), 25),
    "more than 65535 steps at slew speed": (Ramp([(400, 50, -2)], 300, [(400, 50, -2)]), 66_000),
}


@pytest.mark.parametrize("name", UNEVEN)
def test_ramps_of_all_shapes(simulated_controller: Make, name: str) -> None:
    ramp, steps = UNEVEN[name]
    played = play(simulated_controller, ramp.image(fast=True), move_by(steps))
    assert lateness_us(played.steps(), ramp.intervals(steps), 1).max() <= LATE_AT_SPEED_US
    played.assert_nothing_lost()


def test_half_a_step_a_second(simulated_controller: Make) -> None:
    """Two seconds between two pulses, exact to half a microsecond; in both, some 2.2 s are played."""
    slow = Ramp([], 4_000_000, [])

    def two_pulses(client: BusyClient) -> None:
        client.move_by(3)
        until_made(client, 2)
        client.expect_ok(HALT)

    played = play(simulated_controller, slow.image(), two_pulses)
    assert np.diff(played.steps()).tolist() == pytest.approx([32_000_000], abs=16)


def test_there_and_back(simulated_controller: Make) -> None:
    """Each move for itself is good, and the position is that of the pins."""
    plan, targets = PLANS["fast clock"], (500, -300, 100, 1, -1)
    played = play(simulated_controller, image([plan]), *(move_by(steps) for steps in targets))
    played.assert_nothing_lost()
    assert played.statuses[0].position == sum(targets)
    made = played.steps()
    for steps in targets:
        part, made = made[: abs(steps)], made[abs(steps) :]
        ended = played.edges["cycle"] < (made[0] if made.size else np.inf)
        begun = played.edges["cycle"] >= part[0] - 31 * CYCLES_PER_US
        assert_good(with_direction(played.edges, begun & ended), plan.limits(steps))


def with_direction(edges: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """Return the chosen edges, and those of the direction pin before them."""
    first = edges["cycle"][chosen][0]
    return edges[chosen | ((edges["pin"] == 5) & (edges["cycle"] < first))]


def test_nothing_moves_unasked(simulated_controller: Make) -> None:
    """Neither at start, nor when a ramp is stored, nor at a reset."""
    with simulated_controller(real_time=False) as simulated, Client(simulated.port) as client:
        client.hello()
        client.push(PLANS["lead screw"].ramp)
        simulated.press_reset()
        client.hello_until_answered()
        assert client.status().position == 0
    assert not np.isin(simulated.edges()["pin"], (2, 3, 4, 12)).any()


@pytest.mark.usefixtures("simulated_controller")
def test_a_slew_of_any_length(tmp_path: Path, record_property: Record) -> None:
    """150,000 steps/s for a second: up a ramp and down again, and with none at all. Two controllers at a time."""
    ramps = (PLANS["150,000"].ramp, Ramp([], 106, []))
    jobs = [
        partial(play, partial(controller_in, tmp_path / str(i)), ramp.image(fast=True), move_by(150_000))
        for i, ramp in enumerate(ramps)
    ]
    for played, ramp in zip(at_the_same_time(*jobs), ramps, strict=True):
        late = lateness_us(played.steps(), ramp.intervals(150_000), 1)
        record_property("late_us", float(late.max()))
        assert late.max() <= LATE_AT_SPEED_US
        played.assert_nothing_lost()
