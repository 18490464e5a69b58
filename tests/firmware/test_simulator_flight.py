"""Orders in flight on the simulated chip: a new target, a new speed, stop and halt."""

import time
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest

from firmware.checker import CYCLES_PER_US, AxisEdges, assert_good, axis_of
from firmware.protocol import (
    HALT,
    MOVE_TO,
    MOVING,
    OUT_OF_RANGE,
    RUN,
    SET_POSITION,
    SLOW_HZ,
    STOP,
    Ramp,
    expand,
    for_axes,
)
from firmware.rig import BusyClient, Make, Played, RampDesign, Work, image, move_by, play, request, until_made
from simulator.avr import CLOCK_HZ

PLAN = RampDesign(20_000, 200_000, 100_000)
"""1000 steps up, 2000 down."""
SLOW = RampDesign(15_000, 120_000, 80_000, SLOW_HZ)
FAST = RampDesign(150_944, 8_000_000, 10_000_000)
ANSWER_WITHIN_S, ANSWER_ANYTHING_WITHIN_S = 0.010, 0.100
SECONDS_OF_A_STOP_ON_THE_LINE = 20 * 10 / 115_200
"""And of its answer."""


def retargeted(first: int, at_step: int, then: int) -> Work:
    def work(client: BusyClient) -> None:
        client.move_to(first)
        until_made(client, at_step)
        client.move_to(then)

    return work


def runs_of(made: AxisEdges) -> list[AxisEdges]:
    """Return what was made in one direction each."""
    ends = [0, *(np.flatnonzero(np.diff(made.forward.astype(int))) + 1), made.steps.size]
    return [AxisEdges(made.steps[a:b], made.ends[a:b], made.turns, made.forward[a:b]) for a, b in pairwise(ends)]


def only(played: Played, part: AxisEdges) -> np.ndarray:
    """Return the edges of a part of a move, its pin's direction included."""
    chosen = (played.edges["cycle"] >= part.steps[0]) & (played.edges["cycle"] <= part.ends[-1])
    return played.edges[chosen | ((played.edges["pin"] == 5) & (played.edges["cycle"] < part.steps[0]))]


@pytest.mark.parametrize("plan", [PLAN, SLOW], ids=["fast clock", "slow clock"])
@pytest.mark.parametrize(
    ("at_step", "then"), [(300, 9000), (300, 3000), (2500, 9000), (5000, 9000), (900, 1000), (300, -500), (4000, 0)]
)
def test_a_new_target_in_flight(simulated_controller: Make, plan: RampDesign, at_step: int, then: int) -> None:
    """The motor comes to rest at the new target, along good ramps; when it has to turn, through rest."""
    played = play(simulated_controller, image([plan]), retargeted(6000, at_step, then))
    played.assert_nothing_lost()
    assert played.statuses[0].position == then
    parts = runs_of(played.axis())
    assert len(parts) <= 3
    assert then < 6000 or len(parts) == 1
    for part in parts:
        assert_good(only(played, part), plan.limits(part.travel, is_one_way=at_step < 5000))


def test_a_run_and_its_changes_of_speed(simulated_controller: Make) -> None:
    """Faster and slower along the ramp, in the other direction through rest, and an end by the interval 0."""
    held: list[int] = []

    def work(client: BusyClient) -> None:
        for interval in (4000, 1000, 2000, -1500):
            client.expect_ok(RUN, for_axes({0: interval}))
            while client.status().interval != abs(interval):
                pass
            until_made(client, client.status().steps_made + 100)
            held.append(client.status().interval)
        client.expect_ok(RUN, for_axes({0: 0}))

    played = play(simulated_controller, image([PLAN]), work)
    played.assert_nothing_lost()
    assert held == [4000, 1000, 2000, 1500]
    forward, backward = runs_of(played.axis())
    intervals = np.diff(forward.steps)
    levels = [np.flatnonzero(np.abs(intervals - interval) <= 1) for interval in (4000, 1000, 2000)]
    assert all(level.size >= 60 for level in levels)
    assert levels[0][0] < levels[1][0] < levels[1][-1] < levels[2][-1]
    assert_good(only(played, backward), PLAN.limits(backward.travel))


def test_a_run_is_not_faster_than_the_ramp(simulated_controller: Make) -> None:
    def work(client: BusyClient) -> None:
        assert client.request(RUN, for_axes({0: PLAN.slew - 1}))[0] == OUT_OF_RANGE

    assert play(simulated_controller, image([PLAN]), work).steps().size == 0


@pytest.mark.parametrize("at_step", [1, 400, 990, 4500])
@pytest.mark.parametrize("plan", [PLAN, SLOW], ids=["fast clock", "slow clock"])
def test_stop_anywhere(simulated_controller: Make, plan: RampDesign, at_step: int) -> None:
    def work(client: BusyClient) -> None:
        client.move_by(6000)
        until_made(client, at_step)
        client.expect_ok(STOP)
        client.expect_ok(STOP)

    played = play(simulated_controller, image([plan]), work)
    played.assert_nothing_lost()
    made = played.statuses[0].position
    assert at_step <= made < 6000 or at_step == 4500
    assert played.statuses[0].target == made
    assert_good(played.edges, plan.limits(made))


def halted(at_step: int) -> Work:
    def work(client: BusyClient) -> None:
        client.move_by(-200_000)
        until_made(client, at_step)
        client.expect_ok(HALT)
        status = client.status()
        assert status.axis_state == 0
        assert client.status() == status

    return work


@pytest.mark.parametrize("at_step", [1, 500, 20_000])
def test_halt_knows_every_step(simulated_controller: Make, at_step: int) -> None:
    """It is where its pulses have led it; and it comes back to where it began."""
    played = play(simulated_controller, image([FAST]), halted(at_step), request(MOVE_TO, for_axes({0: 0})))
    played.assert_nothing_lost()
    assert played.statuses[0].position == 0
    away, back = runs_of(played.axis())
    assert -away.travel == back.travel >= at_step
    assert_good(only(played, back), FAST.limits(back.travel, late_us=5))


@pytest.mark.parametrize("kind", [STOP, HALT])
def test_stop_and_halt_are_answered_at_once(
    simulated_controller: Make, record_property: Callable[..., None], kind: int
) -> None:
    """Within 10 ms at 150,000 steps/s. The ramp is stored before, as checking one takes longer."""
    with simulated_controller() as simulated, BusyClient(simulated.port) as client:
        client.hello()
        client.push(image([FAST]))
    with simulated, BusyClient(simulated.port) as client:
        client.hello()
        client.move_by(2_000_000)
        time.sleep(0.1)
        client.expect_ok(kind)
        time.sleep(0.1)
        status = client.wait_until_idle()
    longest_s = simulated.statistics["longest_answer_cycles"] / CLOCK_HZ
    record_property("longest_answer_ms", longest_s * 1e3)
    assert longest_s + SECONDS_OF_A_STOP_ON_THE_LINE < ANSWER_WITHIN_S
    assert simulated.statistics["lost_bytes"] == 0
    assert status.position == axis_of(simulated.edges()).travel


def test_set_position(simulated_controller: Make) -> None:
    """At rest only; moves go on from there."""

    def work(client: BusyClient) -> None:
        client.move_by(3000)
        assert client.request(SET_POSITION, for_axes({0: 7}))[0] == MOVING
        client.wait_until_idle()
        client.expect_ok(SET_POSITION, for_axes({0: -1000}))
        client.move_to(-1010)

    played = play(simulated_controller, image([PLAN]), work)
    assert played.statuses[0].position == -1010
    assert [part.travel for part in runs_of(played.axis())] == [3000, -10]


def test_status_on_the_way(simulated_controller: Make) -> None:
    """Position, steps made and interval are those of one instant; after the last step comes a silence of its own."""
    plan = Ramp(
        [(20_000, 1, 0), (14_142, 2, -2595), (10_000, 300, -20)], 2000, [(20_000, 2, -5858), (11_547, 40, -200)]
    )
    played = play(simulated_controller, plan.image(), move_by(-1000))
    intervals = plan.intervals(1000)
    moving = [status for status in played.on_the_way if status.axis_state]
    assert len(moving) > 10
    for status in moving:
        assert status.position == -status.steps_made
        assert status.target == -1000
        around = intervals[max(status.steps_made - 2, 0) : status.steps_made + 2]
        assert status.steps_made == 1000 or min(around) <= status.interval <= max(around)
    assert len(expand(plan.up)) == 303
    assert np.diff(played.steps()).min() >= 2000 * 8 - 2 * CYCLES_PER_US
