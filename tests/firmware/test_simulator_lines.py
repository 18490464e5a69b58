"""Straight lines on the simulated chip: the axis with most steps keeps to its ramp, the others to the line."""

from collections.abc import Callable

import numpy as np
import pytest

from firmware.checker import Cycles, assert_good, lateness_us
from firmware.protocol import HALT, LINE, MOVING, STOP, Settings
from firmware.rig import BusyClient, Make, Played, RampDesign, Work, along_a_line, image, move_by, play, until_made

PLANS = {
    2: RampDesign(120_301, 6_000_000, 6_000_000),
    3: RampDesign(100_000, 5_000_000, 5_000_000),
    4: RampDesign(88_395, 4_500_000, 4_500_000),
}
"""As fast as a line of so many axes may be."""
STEPS = (20_000, -19_999, 12_345, -3)
SLOW = RampDesign(20_000, 400_000, 400_000)
LATE_US = 10.0
LATE_AT_A_PIECE_US = 12.0
"""Of the step before a next piece begins, and a few after it."""
TOGETHER_CYCLES = 16
"""The pins of an event rise together, axis 3's a few cycles after the others'."""


def check_line(played: Played, plan: RampDesign, steps: tuple[int, ...], late_us: float = LATE_US) -> float:
    """The leader keeps to its ramp, the m-th step of each other comes with its step ceil(L (2 m - 1) / (2 D))."""
    most = max(abs(count) for count in steps)
    leader = [abs(count) for count in steps].index(most)
    lead = played.steps(leader)
    late = float(lateness_us(lead, plan.ramp.intervals(most), plan.cycles_per_tick).max())
    assert late <= late_us
    assert_good(played.edges, plan.limits(steps[leader], late_us=late_us), leader)
    for axis, count in enumerate(steps):
        check_follower(lead, played.steps(axis), count)
        assert played.axis(axis).travel == count
    return late


def check_follower(lead: Cycles, made: Cycles, count: int) -> None:
    m = np.arange(1, abs(count) + 1)
    with_lead = -(-lead.size * (2 * m - 1) // (2 * abs(count))) if count else m
    assert made.size == m.size
    assert (np.abs(made - lead[with_lead - 1]) <= TOGETHER_CYCLES).all()


@pytest.mark.parametrize("count", PLANS)
def test_lines_at_their_highest_speed(
    simulated_controller: Make, record_property: Callable[..., None], count: int
) -> None:
    plans = [PLANS[count]] * count
    played = play(simulated_controller, image(plans), along_a_line(*STEPS[:count]))
    played.assert_nothing_lost()
    record_property("late_us", check_line(played, PLANS[count], STEPS[:count]))


@pytest.mark.parametrize("steps", [(300, 300, -300, 300), (1, 0, -2, 400), (0, -500, 0, 0), (0, 0, 0, 1), (7, 5, 3, 2)])
def test_lines_of_all_slopes(simulated_controller: Make, steps: tuple[int, ...]) -> None:
    played = play(simulated_controller, image([SLOW] * 4), along_a_line(*steps))
    played.assert_nothing_lost()
    check_line(played, SLOW, steps)


@pytest.mark.parametrize("count", PLANS)
def test_a_line_of_several_pieces(simulated_controller: Make, record_property: Callable[..., None], count: int) -> None:
    """Each piece begins and ends within half a step of the line, and no step is late where the next one begins."""
    fast, steps = PLANS[count], (70_000, -23_456, 69_999, -69_998)[:count]
    played = play(simulated_controller, image([fast] * count), along_a_line(*steps))
    played.assert_nothing_lost()
    lead = played.steps(0)
    for axis, whole in list(enumerate(steps))[1:]:
        made = played.steps(axis)
        assert (lead.size, made.size) == (70_000, abs(whole))
        at = np.searchsorted(made, lead + TOGETHER_CYCLES)
        assert np.abs(at - np.arange(1, 70_001) * abs(whole) / 70_000).max() <= 1
    late = float(lateness_us(lead, fast.ramp.intervals(70_000), 1).max())
    record_property("late_us", late)
    assert late <= LATE_AT_A_PIECE_US


def test_lines_and_moves_take_turns(simulated_controller: Make) -> None:
    """After a line each axis has its own ramp and its own direction again."""
    work = (along_a_line(200, -100), move_by(-50, 60), along_a_line(-30, -40), move_by(1, 1))
    played = play(simulated_controller, image([SLOW] * 2), *work)
    played.assert_nothing_lost()
    assert [status.position for status in played.statuses] == [200 - 50 - 30 + 1, -100 + 60 - 40 + 1]
    assert [played.steps(axis).size for axis in range(2)] == [200 + 50 + 30 + 1, 100 + 60 + 40 + 1]


def left_early(kind: int) -> Work:
    def work(client: BusyClient) -> None:
        along_a_line(50_000, -30_000, 777)(client)
        until_made(client, 1500)
        assert client.request(LINE, bytes([1, 0, 1, 0, 0, 0]))[0] == MOVING
        client.expect_ok(kind, b"\1")

    return work


@pytest.mark.parametrize("kind", [STOP, HALT])
def test_a_line_is_left_early(simulated_controller: Make, kind: int) -> None:
    """It stays on the line, and each axis is where its pins have led it."""
    played = play(simulated_controller, image([SLOW] * 3), left_early(kind))
    played.assert_nothing_lost()
    lead = played.statuses[0].position
    assert 1500 <= lead < 50_000
    for axis, whole in ((1, -30_000), (2, 777)):
        # A step is made where the piece, of 32,768 of the leader's steps, calls for it: that ends within half a step of
        # the line, and the axis is within half a step of the piece.
        assert abs(played.statuses[axis].position - lead * whole / 50_000) <= 1
    if kind == STOP:
        assert_good(played.edges, SLOW.limits(lead, late_us=LATE_US))


def test_both_edges_on_a_line(simulated_controller: Make) -> None:
    """Each edge of axis 1 is a step; the others make pulses."""
    settings = Settings(both_edges=0b0010)
    played = play(simulated_controller, image([SLOW] * 3), along_a_line(400, 300, -200), settings=settings)
    assert [played.axis(axis, settings).travel for axis in range(3)] == [400, 300, -200]
    check_follower(played.steps(0), played.axis(1, settings).steps, 300)
    check_follower(played.steps(0), played.steps(2), -200)
