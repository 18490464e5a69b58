"""Several axes: at the same time, and along a straight line."""

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from firmware.host import Host
from firmware.machine.ramps import QUICK, SHARP
from firmware.motion import OK, OUT_OF_RANGE, TOO_FAST, Machine, StoredRamp, image_of

LEVEL = StoredRamp((), 2500, ())
LONE = StoredRamp((5000, 4000), 3000, (6000, 4500, 3500))
FOUR = image_of(QUICK, SHARP, LEVEL, LONE)
counts = st.lists(st.integers(-150, 150), min_size=4, max_size=4)


@given(targets=counts)
def test_four_axes_at_the_same_time(host: Host, targets: list[int]) -> None:
    """Each along its own ramp, and all from one instant."""
    machine = Machine(host, FOUR)
    assert machine.move(*targets) == (OK, 0)
    machine.rest()
    starts = set()
    assert [machine.report(axis).position for axis in range(4)] == targets
    for ramp, target, made in zip((QUICK, SHARP, LEVEL, LONE), targets, machine.all_steps(), strict=False):
        assert made.travel == target
        assert made.intervals == ramp.move(abs(target))[:-1]
        starts.update(made.times[:1])
    assert len(starts) <= 1


@given(wait=st.integers(0, 60_000), later=st.integers(-80, 80), target=st.integers(-80, 80))
def test_an_axis_may_start_while_others_move(host: Host, wait: int, later: int, target: int) -> None:
    machine = Machine(host, FOUR)
    machine.ask("move", 0b0001, 200)
    machine.do("wait", wait)
    machine.ask("move", 0b1010, 0, later, 0, target)
    machine.rest()
    quick, sharp, _, lone = machine.all_steps()
    assert quick.intervals == QUICK.move(200)[:-1]
    assert sharp.intervals == SHARP.move(abs(later))[:-1]
    assert lone.intervals == LONE.move(abs(target))[:-1]
    assert (sharp.travel, lone.travel) == (later, target)


def test_stop_and_halt_of_some_axes(host: Host) -> None:
    machine = Machine(host, FOUR)
    machine.move(300, 300, 300, 300)
    machine.do("wait", 60_000)
    machine.do("stop", 0b0001)
    machine.do("halt", 0b0100)
    halted = machine.report(2).position
    machine.rest()
    made = [steps.travel for steps in machine.all_steps()]
    assert made == [machine.report(axis).position for axis in range(4)]
    assert 0 < made[0] < 300
    assert made[1:] == [300, halted, 300]


def test_a_ramp_may_be_shared(host: Host) -> None:
    ramp = QUICK.encode()
    machine = Machine(host, bytes([2, 0, 3, 1, 0, 0, 0]) + ramp)
    machine.move(20, -50, 120)
    machine.rest()
    for steps, made in zip((20, 50, 120), machine.all_steps(), strict=False):
        assert made.intervals == QUICK.move(steps)[:-1]


def steps_together(leader_steps: int, steps: int) -> list[int]:
    """Return with which step of the leader each step of a follower comes: the nearest, halves up."""
    made = [(2 * i * steps + leader_steps) // (2 * leader_steps) for i in range(leader_steps + 1)]
    return [i for i in range(1, leader_steps + 1) if made[i] > made[i - 1]]


@given(steps=counts)
@example(steps=[150, -150, 0, 1])
@example(steps=[0, 0, 0, -3])
@example(steps=[7, 100, 99, -50])
def test_a_line(host: Host, steps: list[int]) -> None:
    """The axis with most steps plays the ramp, the others make theirs together with it (Bresenham)."""
    machine = Machine(host, FOUR)
    assert machine.ask("line", 15, 0, *steps) == (OK, 0)
    assert [machine.report(axis).target for axis in range(4)] == steps
    machine.rest()
    assert [machine.report(axis).position for axis in range(4)] == steps
    most = max(abs(s) for s in steps)
    leader = [abs(s) for s in steps].index(most)
    made = machine.all_steps()
    assert made[leader].intervals == QUICK.move(most)[:-1]
    for follower, count in zip(made, steps, strict=True):
        assert follower.travel == count
        if count:
            assert follower.times == [made[leader].times[i - 1] for i in steps_together(most, abs(count))]
    machine.move(*(0 for _ in steps))
    machine.rest()
    assert [made.travel for made in machine.all_steps()] == [-s for s in steps]


@pytest.mark.parametrize("order", ["stop", "halt"])
@given(steps=counts, wait=st.integers(0, 150_000))
def test_a_line_is_left_early(host: Host, order: str, steps: list[int], wait: int) -> None:
    """By any of its axes: it stays on the line, and every axis knows where it is."""
    machine = Machine(host, FOUR)
    machine.ask("line", 15, 1, *steps)
    machine.do("wait", wait)
    machine.do(order, next((1 << axis for axis, count in enumerate(steps) if count), 15))
    if order == "halt":
        assert machine.report().state == 0
    targets = [machine.report(axis).target for axis in range(4)]
    machine.rest()
    assert targets == [machine.report(axis).position for axis in range(4)]
    made = [axis.travel for axis in machine.all_steps()]
    assert made == [machine.report(axis).position for axis in range(4)]
    most = max(abs(s) for s in steps)
    leader = [abs(s) for s in steps].index(most)
    for count, whole in zip(made, steps, strict=True):
        if most:
            assert abs(count) == (2 * abs(made[leader]) * abs(whole) + most) // (2 * most)


@pytest.mark.parametrize("order", ["stop", "halt"])
def test_axes_beside_a_line_do_not_end_it(host: Host, order: str) -> None:
    machine = Machine(host, FOUR)
    machine.ask("line", 15, 0, 100, -60, 0, 0)
    machine.do("wait", 60_000)
    machine.do(order, 0b1100)
    machine.rest()
    assert [machine.report(axis).position for axis in range(4)] == [100, -60, 0, 0]


def test_a_line_is_reported_on_its_way(host: Host) -> None:
    machine = Machine(host, FOUR)
    machine.ask("line", 15, 0, 100, -60, 0, 33)
    for _ in range(40):
        machine.do("wait", 7000)
        reports = [machine.report(axis) for axis in range(4)]
        lead = reports[0].position
        assert reports[1].position == -((2 * lead * 60 + 100) // 200)
        assert reports[3].position == (2 * lead * 33 + 100) // 200
        assert [r.target for r in reports] == [100, -60, 0, 33]


def test_a_line_of_more_steps_than_the_engine_counts(host: Host) -> None:
    """In pieces of 32,768 steps, each of which begins and ends within half a step of the line."""
    quick = StoredRamp((200, 150), 125, (200, 150))
    machine = Machine(host, image_of(quick, quick, quick))
    machine.ask("line", 7, 0, 150_000, 99_999, -1)
    machine.rest()
    leader, half, single = machine.all_steps()[:3]
    assert (leader.travel, half.travel, single.travel) == (150_000, 99_999, -1)
    at = {time: i + 1 for i, time in enumerate(leader.times)}
    for i, time in enumerate(half.times):
        assert abs((i + 1) / 99_999 * 150_000 - at[time]) <= 2
    assert machine.report(0).starved == 0


@pytest.mark.parametrize("leader", [16_384, 32_767, 32_768, 32_769, 65_536, 65_537])
def test_a_line_of_whole_pieces(host: Host, leader: int) -> None:
    quick = StoredRamp((200, 150), 125, (200, 150))
    machine = Machine(host, image_of(quick, quick, quick, quick))
    steps = (leader, 1 - leader, leader // 2, -1)
    machine.ask("line", 15, 0, *steps)
    machine.rest()
    made = machine.all_steps()
    assert tuple(axis.travel for axis in made) == steps
    at = {time: i + 1 for i, time in enumerate(made[0].times)}
    for axis, count in zip(made[1:], steps[1:], strict=True):
        apart = [abs((i + 0.5) * leader / abs(count) - at[time]) for i, time in enumerate(axis.times)]
        assert max(apart) <= leader / abs(count) + 1


def test_a_halt_where_a_line_has_just_ended(host: Host) -> None:
    """Its leader rests already, and the main loop hasn't ended the line yet."""
    quick = StoredRamp((200, 150), 125, (200, 150))
    machine = Machine(host, image_of(quick, quick, quick))
    machine.ask("line", 7, 0, 400, -300, 77)
    ticks_of_line = machine.rest() - machine.all_steps()[0].times[0]
    for wait in range(ticks_of_line - 2000, ticks_of_line + 4000, 100):
        machine = Machine(host, image_of(quick, quick, quick))
        machine.ask("line", 7, 0, 400, -300, 77)
        machine.report(1)  # which counts how far it has been played by then
        machine.do("stop_comes", 1)
        machine.do("wait", wait)
        machine.do("halt", 7)
        machine.do("stop_comes", 0)
        reached = [machine.report(axis).position for axis in range(3)]
        assert reached == [axis.travel for axis in machine.all_steps()[:3]], wait


@pytest.mark.parametrize("wait_ms", [5, 2000, 4100, 8200, 12_400, 18_300])
def test_a_long_line_that_is_stopped_knows_where_it_ends(host: Host, wait_ms: int) -> None:
    quick = StoredRamp((200, 150), 125, (*range(200, 125, -1),) * 3)
    machine = Machine(host, image_of(quick, quick, quick))
    machine.ask("line", 7, 0, 150_000, -99_999, 77_773)
    machine.do("wait", 1000 * wait_ms)
    machine.do("stop", 2)
    targets = [machine.report(axis).target for axis in range(3)]
    machine.rest()
    assert 0 < targets[0] < 150_000
    assert targets == [machine.report(axis).position for axis in range(3)]
    assert targets == [steps.travel for steps in machine.all_steps()[:3]]


def test_a_line_within_the_range_of_positions(host: Host) -> None:
    machine = Machine(host, FOUR)
    machine.do("position", 2, 0, 2**31 - 5)
    assert machine.ask("line", 3, 0, 100, 5) == (OUT_OF_RANGE, 1)
    assert machine.ask("line", 3, 4, 100, 4) == (OUT_OF_RANGE, 4)
    assert machine.ask("line", 3, 0, 100, 4) == (OK, 0)


@pytest.mark.parametrize(
    ("axes", "interval", "status"),
    [
        (1, 106, OK),
        (2, 246, OK),
        (2, 245, TOO_FAST),
        (3, 388, OK),
        (3, 387, TOO_FAST),
        (4, 533, OK),
        (4, 532, TOO_FAST),
    ],
)
def test_the_fastest_axes_together(host: Host, axes: int, interval: int, status: int) -> None:
    """65,000, 41,000 and 30,000 steps/s each."""
    machine = Machine(host, image_of(*[StoredRamp((), interval, ())] * axes, fast=True), round_ticks=1000)
    assert machine.move(*[100] * axes)[0] == status
    machine.rest()
    assert machine.report().starved == 0


@pytest.mark.parametrize(
    ("axes", "interval", "status"),
    [(2, 133, OK), (2, 132, TOO_FAST), (3, 160, OK), (3, 159, TOO_FAST), (4, 181, OK), (4, 180, TOO_FAST)],
)
def test_the_fastest_lines(host: Host, axes: int, interval: int, status: int) -> None:
    """120,000, 100,000 and 88,000 steps/s."""
    machine = Machine(host, image_of(*[StoredRamp((), interval, ())] * axes, fast=True), round_ticks=1000)
    assert machine.ask("line", (1 << axes) - 1, 0, *[100] * axes)[0] == status


def test_an_axis_that_would_be_one_too_many(host: Host) -> None:
    """The share of those that move already counts."""
    machine = Machine(host, image_of(StoredRamp((), 200, ()), StoredRamp((), 400, ()), fast=True), round_ticks=1000)
    assert machine.ask("move", 1, 100_000) == (OK, 0)
    machine.do("wait", 100_000)
    assert machine.ask("move", 2, 0, 10) == (OK, 0)
    machine.do("halt", 15)
    fast = StoredRamp((), 150, ())
    machine = Machine(host, image_of(fast, fast, fast=True), round_ticks=1000)
    machine.ask("move", 1, 100_000)
    assert machine.ask("move", 2, 0, 10) == (TOO_FAST, 163)


SLOWING = StoredRamp((), 107, (20_000, 10_000, 5000, *[1000] * 20_000))


def test_an_axis_that_slows_down_counts_with_the_speed_it_has(host: Host) -> None:
    """Told in the same request, and until it is as slow as that. (246 / 2) / 107 + (246 / 2) / 124."""
    machine = Machine(host, image_of(SLOWING, StoredRamp((), 124, ()), fast=True), round_ticks=1000)
    both = 100 * 246 // 2 * (107 + 124) // (107 * 124)
    assert machine.ask("run", 1, 107) == (OK, 0)
    machine.do("wait", 100_000)
    status, percent = machine.ask("run", 3, 100_000, 124)
    assert (status, percent) == (TOO_FAST, both)
    assert machine.ask("run", 3, 0, 124)[0] == TOO_FAST
    assert machine.ask("run", 1, 100_000) == (OK, 0)
    assert machine.ask("run", 2, 0, 124) == (TOO_FAST, both)  # the queue goes on at 107 ticks
    machine.do("wait", 30_000_000)
    assert machine.report(0).interval == 100_000
    assert machine.ask("run", 2, 0, 124) == (OK, 0)
    machine.do("halt", 3)


def test_gauges_have_three_axes_and_a_limit_of_their_own(host: Host) -> None:
    settings = bytes([1, 0, 0, 0, 0, 0]) + (30).to_bytes(2, "little") + bytes(4)
    machine = Machine(host, FOUR, settings)
    assert machine.move(1, 1, 1) == (OK, 0)
    assert machine.ask("move", 8, 0, 0, 0, 1) == (OUT_OF_RANGE, 8)
    machine = Machine(host, image_of(StoredRamp((), 399, ())), settings)
    assert machine.move(1) == (TOO_FAST, 100)
