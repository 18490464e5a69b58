"""Several axes at the same time on the simulated chip, each judged as if it were alone."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from firmware.checker import assert_good, lateness_us
from firmware.protocol import HALT, IN_MOTION, MOVE_BY, STOP, for_axes
from firmware.rig import BusyClient, Make, RampDesign, image, move_by, play, request, until_made

SPEEDS = {2: 65_040, 3: 41_237, 4: 30_019}
"""[steps/s] of each axis, when so many move: as fast as the limits in whole ticks allow."""
LATE_US = {2: 15, 3: 25, 4: 50}
"""Most of it where several axes load a segment at the same instant."""
STEPS = (5000, -6000, 5500, -4500)
MIXED = (
    RampDesign(20_000, 400_000, 400_000),
    RampDesign(9000, 90_000, 90_000),
    RampDesign(25_000, 900_000, 900_000),
    RampDesign(500, 4000, 4000),
)
MIXED_STEPS = (2000, -700, 3000, 40)


def check_axes(played: object, plans: Sequence[RampDesign], steps: Sequence[int], late_us: float) -> list[float]:
    """Each axis keeps to its plan and to its design; return how late they are [us]."""
    late = []
    for axis, (plan, count) in enumerate(zip(plans, steps, strict=True)):
        made = played.steps(axis)  # type: ignore[attr-defined]  # of Played
        late.append(float(lateness_us(made, plan.ramp.intervals(abs(count)), plan.cycles_per_tick).max()))
        assert late[-1] <= late_us
        assert_good(played.edges, plan.limits(count, late_us=late_us), axis)  # type: ignore[attr-defined]
    return late


@pytest.mark.parametrize("count", SPEEDS)
def test_axes_at_their_highest_speed(
    simulated_controller: Make, record_property: Callable[..., None], count: int
) -> None:
    """The serial port busy both ways: no step is lost, and none later than stated."""
    plans = [RampDesign(SPEEDS[count], 30 * SPEEDS[count], 40 * SPEEDS[count])] * count
    played = play(simulated_controller, image(plans), move_by(*STEPS[:count]))
    played.assert_nothing_lost()
    record_property("late_us", check_axes(played, plans, STEPS[:count], LATE_US[count]))


@pytest.mark.parametrize("speed", [2000, 10_000, 20_000, 25_000])
def test_four_axes_at_other_speeds(simulated_controller: Make, speed: int) -> None:
    """Alike, so that all of them need their next segments at the same instants."""
    plan = RampDesign(speed, 40 * speed, 40 * speed)
    steps = (speed // 10,) * 4
    played = play(simulated_controller, image([plan] * 4), move_by(*steps))
    played.assert_nothing_lost()
    check_axes(played, [plan] * 4, steps, LATE_US[4])


def test_four_different_axes(simulated_controller: Make) -> None:
    played = play(simulated_controller, image(MIXED), move_by(*MIXED_STEPS))
    played.assert_nothing_lost()
    check_axes(played, MIXED, MIXED_STEPS, LATE_US[4])


def test_axes_of_one_request_set_out_together(simulated_controller: Make) -> None:
    played = play(simulated_controller, image(MIXED), move_by(*MIXED_STEPS))
    first = [played.steps(axis)[0] for axis in range(4)]
    assert np.ptp(first) <= LATE_US[4] * 16


def test_axes_set_out_and_stop_one_by_one(simulated_controller: Make) -> None:
    """The others don't notice: their intervals stay as planned."""

    def one_by_one(client: BusyClient) -> None:
        client.expect_ok(MOVE_BY, for_axes({2: 30_000}))
        until_made(client, 300, 2)
        client.expect_ok(MOVE_BY, for_axes({0: 2500, 3: -25}))
        until_made(client, 500, 0)
        client.expect_ok(MOVE_BY, for_axes({1: -5000}))
        until_made(client, 100, 1)
        client.expect_ok(STOP, b"\2")
        assert client.status(1).axis_state != IN_MOTION

    played = play(simulated_controller, image(MIXED), one_by_one)
    played.assert_nothing_lost()
    assert -5000 < played.statuses[1].position < 0
    moved = (2500, played.statuses[1].position, 30_000, -25)
    for axis in (0, 2, 3):
        planned = MIXED[axis].ramp.intervals(abs(moved[axis]))
        assert lateness_us(played.steps(axis), planned, 1).max() <= LATE_US[4]
    assert_good(played.edges, MIXED[1].limits(moved[1], late_us=LATE_US[4]), 1)


def test_all_are_halted_at_full_speed(simulated_controller: Make) -> None:
    def halt(client: BusyClient) -> None:
        client.expect_ok(MOVE_BY, for_axes(dict.fromkeys(range(4), 100_000)))
        until_made(client, 3000, 0)
        client.expect_ok(HALT)
        assert {client.status(axis).axis_state for axis in range(4)} == {0}

    played = play(simulated_controller, image([RampDesign(30_000, 900_000, 900_000)] * 4), halt, request(STOP))
    played.assert_nothing_lost()
    assert all(3000 <= status.position < 100_000 for status in played.statuses)
