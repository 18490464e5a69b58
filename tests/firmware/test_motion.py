"""Moves of one axis: the firmware's machine on its engine in C, against the rule that the protocol states."""

import itertools
import math
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from firmware.host import Host, missing_compiler
from firmware.motion import (
    FAST_HZ,
    NO_RAMP,
    OK,
    OUT_OF_RANGE,
    SETUP_TICKS,
    SLOW_HZ,
    TOO_FAST,
    Machine,
    Steps,
    StoredRamp,
    build,
    image_of,
)
from tools import require

MOST_REST_TICKS = 400 + 10 * 100 + 440 + SETUP_TICKS[SLOW_HZ]
"""What a rest on the way adds to an interval, at most: the silence that ends a move, the rounds of the main loop that
queue the next one, its start, and the silence in which the direction settles."""


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    require(*missing_compiler())
    return build(tmp_path_factory.mktemp("motion"))


@pytest.fixture(scope="module")
def host(program: Path) -> Iterator[Host]:
    with Host(program) as running:
        yield running


def slope(slew_speed: float, acceleration: float, hz: int = SLOW_HZ) -> tuple[int, ...]:
    """Return intervals from rest to a speed by formula (9) [ticks]."""
    steps = int(slew_speed**2 / (2 * acceleration))
    return tuple(round(hz / math.sqrt(2 * acceleration * i)) for i in range(1, steps + 1))


def coarse_slope(slew_speed: float, acceleration: float, segments: int) -> tuple[int, ...]:
    """Return intervals from rest to a speed that never rise, in so many segments of as many steps [fast ticks]."""
    steps = int(slew_speed**2 / (2 * acceleration)) // segments
    firsts = [FAST_HZ / math.sqrt(2 * acceleration * max(steps * i, 1)) for i in range(segments + 1)]
    falls = [int((first - after) / steps) for first, after in itertools.pairwise(firsts)]
    return tuple(int(first) - fall * i for first, fall in zip(firsts, falls, strict=False) for i in range(steps))


def ramp_of(slew_speed: float, acceleration: float, deceleration: float, hz: int = SLOW_HZ) -> StoredRamp:
    return StoredRamp(slope(slew_speed, acceleration, hz), round(hz / slew_speed), slope(slew_speed, deceleration, hz))


QUICK = ramp_of(1000, 50_000, 20_000)
SHARP = ramp_of(2000, 60_000, 100_000)
RAMPS = (QUICK, SHARP, StoredRamp((), 2000, ()), StoredRamp((4000, 3000), 2000, ()))

falling = st.lists(st.integers(100, 9000), max_size=12).map(lambda intervals: tuple(sorted(intervals, reverse=True)))
uneven = st.lists(st.integers(100, 70_000), max_size=8).map(tuple)


@given(up=falling, down=falling, slew=st.integers(60, 5000), steps=st.integers(-60, 60))
@example(up=(300, 200), down=(300, 200), slew=100, steps=4)
@example(up=(300, 200), down=(250, 200), slew=100, steps=3)
def test_a_move_takes_the_slowest_intervals(
    host: Host, up: tuple[int, ...], down: tuple[int, ...], slew: int, steps: int
) -> None:
    ramp = StoredRamp(up, slew, down)
    machine = Machine(host, image_of(ramp))
    began = machine.rest()
    assert machine.move(steps) == (OK, 0)
    ended = machine.rest()
    made = machine.steps()
    expected = ramp.move(abs(steps))
    assert made.travel == steps
    assert made.intervals == expected[:-1]
    if steps:
        assert made.times[0] - began >= SETUP_TICKS[SLOW_HZ]
        assert ended - made.times[-1] >= expected[-1]
    assert machine.report().position == steps


@given(up=uneven, down=uneven, slew=st.integers(60, 5000), steps=st.integers(1, 40))
def test_a_table_may_be_uneven(host: Host, up: tuple[int, ...], down: tuple[int, ...], slew: int, steps: int) -> None:
    """An interval counts as the shortest of those before it, so that none is overtaken."""
    ramp = StoredRamp(up, slew, down)
    machine = Machine(host, image_of(ramp))
    machine.move(steps)
    machine.rest()
    assert machine.steps().intervals == ramp.move(steps)[:-1]


@pytest.mark.parametrize(("hz", "round_ticks"), [(SLOW_HZ, 100), (SLOW_HZ, 1000), (FAST_HZ, 1000), (FAST_HZ, 8000)])
def test_long_moves_at_both_clocks(host: Host, hz: int, round_ticks: int) -> None:
    """Whatever the main loop does in between, as long as it comes round in time."""
    ramp = ramp_of(12_000, 1_000_000, 800_000, hz)
    machine = Machine(host, image_of(ramp, fast=hz == FAST_HZ), round_ticks=round_ticks)
    machine.move(3000)
    machine.rest()
    assert machine.steps().intervals == ramp.move(3000)[:-1]
    assert machine.report().starved == 0


@pytest.mark.parametrize("interval", [29_999, 30_000, 30_001, 32_768, 65_535, 65_536, 1_000_000, 4_000_000, 2**28 - 1])
def test_long_intervals(host: Host, interval: int) -> None:
    ramp = StoredRamp((interval, interval - 40), interval - 1000, (interval,))
    machine = Machine(host, image_of(ramp))
    machine.move(5)
    machine.rest(10**10)
    assert machine.steps().intervals == ramp.move(5)[:-1]


orders = st.lists(
    st.tuples(
        st.sampled_from(["move", "run", "stop", "halt"]),
        st.integers(-200, 200),
        st.integers(0, 40_000),
    ),
    min_size=1,
    max_size=6,
)


def give_order(machine: Machine, order: str, value: int, ramp: StoredRamp) -> None:
    """Move to a position, run, or stop or halt."""
    if order == "move":
        assert machine.move(value) == (OK, 0)
    elif order == "run":
        interval = ramp.slew + 20 * abs(value)
        assert machine.ask("run", 1, interval if value >= 0 else -interval) == (OK, 0)
    else:
        machine.do(order, 1)


@given(ramp=st.sampled_from(RAMPS), orders=orders, last=st.integers(-300, 300))
@example(ramp=RAMPS[1], orders=[("move", 2, 101)], last=4)
@example(ramp=QUICK, orders=[("move", 200, 20_000)], last=30)
@example(ramp=QUICK, orders=[("move", 200, 20_000), ("move", 10, 3000)], last=-100)
@example(ramp=QUICK, orders=[("run", 100, 30_000), ("run", 20, 30_000), ("run", -50, 30_000)], last=0)
@example(ramp=RAMPS[2], orders=[("run", 100, 30_000), ("run", 20, 30_000), ("run", -50, 30_000)], last=0)
def test_orders_in_flight(host: Host, ramp: StoredRamp, orders: list[tuple[str, int, int]], last: int) -> None:
    """Whatever is asked, and when: the motor obeys its ramp, reverses through rest, and no step is lost."""
    machine = Machine(host, image_of(ramp))
    halted = False
    for order, value, wait in orders:
        give_order(machine, order, value, ramp)
        halted = halted or order == "halt"
        machine.do("wait", wait)
    machine.move(last)
    machine.rest()
    made = machine.steps()
    assert made.travel == last == machine.report().position
    assert machine.report().starved == 0
    if not halted:
        assert_obeys(made, ramp, ramp.slew + 20 * 200)


def assert_obeys(made: Steps, ramp: StoredRamp, slowest_run: int) -> None:
    """No interval is shorter than the next of the way up after the one before it allows, nor longer than the way down
    allows; a run's speed lies between. A direction begins and ends slowly."""
    start = (*ramp.up, ramp.slew)[0]
    landing = (*ramp.down, ramp.slew)[0]
    longest = max(*ramp.up, *ramp.down, ramp.slew, slowest_run)
    for intervals in made.runs(longest):
        if intervals:
            assert intervals[0] >= min(start, landing)
        for before, after in itertools.pairwise(intervals):
            faster = max((i for i in (*ramp.up, ramp.slew) if i < before), default=ramp.slew)
            slower = min((i for i in ramp.down if i > before), default=max(before, slowest_run))
            allowed = range(min(faster, before), max(slower, before) + 1)
            # An order that came too late finds the motor at rest, if only for a moment: it sets out anew.
            rested = landing <= before <= landing + MOST_REST_TICKS and after == start
            rests = range(max(allowed.start, landing), allowed.stop + MOST_REST_TICKS)
            assert rested or after in allowed or after in rests


@given(wait=st.integers(0, 120_000))
def test_stop_slows_down_along_the_ramp(host: Host, wait: int) -> None:
    machine = Machine(host, image_of(QUICK))
    machine.move(5000)
    machine.do("wait", wait)
    machine.do("stop", 1)
    machine.rest()
    report, made = machine.report(), machine.steps()
    assert report.state == 0
    assert report.position == report.target == made.travel
    assert_obeys(made, QUICK, QUICK.slew)
    if len(made.times) > 1:
        assert made.intervals[-1] >= sorted(QUICK.down)[-2] or made.travel <= 2


@given(ramp=st.sampled_from(RAMPS), orders=orders, wait=st.integers(0, 60_000), more=st.integers(-60, 60))
@example(ramp=QUICK, orders=[("run", 100, 30_000)], wait=0, more=5)
@example(ramp=SHARP, orders=[("move", 200, 100)], wait=0, more=-5)
@example(ramp=QUICK, orders=[("move", 200, 70_000), ("move", -10, 100)], wait=0, more=20)
def test_after_a_stop_the_target_is_where_it_comes_to_rest(
    host: Host, ramp: StoredRamp, orders: list[tuple[str, int, int]], wait: int, more: int
) -> None:
    """From the stop on, whatever came before; and what is asked for then may count from there."""
    machine = Machine(host, image_of(ramp))
    for order, value, pause in orders:
        give_order(machine, order, value, ramp)
        machine.do("wait", pause)
    machine.do("stop", 1)
    target = machine.report().target
    machine.do("wait", wait)
    assert machine.report().target == target
    machine.move(target + more)
    machine.rest()
    assert machine.report().position == target + more
    machine.do("stop", 1)
    give_order(machine, *orders[-1][:2], ramp)
    machine.do("wait", orders[-1][2])
    machine.do("stop", 1)
    target = machine.report().target
    machine.rest()
    assert machine.report().position == target == machine.steps().travel


def test_after_a_stop_the_target_is_known_also_on_long_lists(host: Host) -> None:
    """Right after a quick start, when the list of the way down has hardly been read."""
    ramp = StoredRamp(coarse_slope(20_000, 2_000_000, 4), 800, coarse_slope(20_000, 50_000, 80))
    machine = Machine(host, image_of(ramp, fast=True), round_ticks=16_000)
    for wait_ms in range(1, 60):
        machine.ask("run", 1, 800)
        machine.do("wait", wait_ms * 16_000)
        machine.do("stop", 1)
        target = machine.report().target
        machine.rest()
        assert machine.report().position == target


@given(target=st.integers(-400, 400), wait=st.integers(0, 200_000))
@example(target=100, wait=0)
@example(target=-1, wait=20_000)
def test_a_target_passed_is_come_back_to(host: Host, target: int, wait: int) -> None:
    machine = Machine(host, image_of(SHARP))
    machine.move(300)
    machine.do("wait", wait)
    machine.move(target)
    machine.rest()
    made = machine.steps()
    assert made.travel == target
    assert_obeys(made, SHARP, SHARP.slew)
    assert len(made.moves) <= 3


def test_a_farther_target_is_gone_to_without_a_stop(host: Host) -> None:
    """Asked while slowing down: it speeds up again."""
    machine = Machine(host, image_of(QUICK))
    machine.move(100)
    while not machine.report().position > 85:
        machine.do("wait", 200)
    machine.move(400)
    machine.rest()
    made = machine.steps()
    assert len(made.moves) == 1
    assert max(made.intervals[60:300]) < QUICK.up[0]
    assert made.travel == 400


def assert_without_a_stall(intervals: Sequence[int], ramp: StoredRamp) -> None:
    """The motor slows down no faster than its way down does."""
    down = sorted(ramp.down)
    for before, after in itertools.pairwise(intervals):
        slower = bisect_left(down, before + 1)
        assert after <= max(before, down[min(slower, len(down) - 1)])


LONG = StoredRamp(coarse_slope(20_000, 100_000, 40), 800, coarse_slope(20_000, 100_000, 40))
"""2000 steps up and as many down, in 0.2 s each."""


@pytest.mark.parametrize("round_ticks", [8_000, 16_000, 32_000])
@pytest.mark.parametrize("at_ms", range(210, 400, 10))
def test_a_move_that_is_extended_while_it_slows_down_does_not_wait(host: Host, at_ms: int, round_ticks: int) -> None:
    """The place on the way up is near when it is wanted, also when the main loop takes 2 ms for a round."""
    machine = Machine(host, image_of(LONG, fast=True), round_ticks=round_ticks)
    before = machine.report().starved
    machine.move(4200)
    machine.do("wait", at_ms * 16_000)
    machine.move(4220)
    machine.rest()
    made = machine.steps()
    assert machine.report().starved == before
    assert made.travel == 4220
    assert_without_a_stall(made.intervals, LONG)


@pytest.mark.parametrize("round_ticks", [8_000, 16_000, 32_000])
def test_a_run_that_becomes_slower_does_not_wait(host: Host, round_ticks: int) -> None:
    side = coarse_slope(120_000, 600_000, 40)
    ramp = StoredRamp(side, 133, side)
    machine = Machine(host, image_of(ramp, fast=True), round_ticks=round_ticks)
    before = machine.report().starved
    for interval in (133, 2000):
        machine.ask("run", 1, interval)
        machine.do("wait", 400 * 16_000)
        assert machine.report().interval == interval
    assert machine.report().starved == before
    assert_without_a_stall(machine.steps().intervals, ramp)
    machine.do("halt", 1)


def test_running(host: Host) -> None:
    """Up to the speed, slower along the way down, faster along the way up, back through rest, and a stop by 0."""
    machine = Machine(host, image_of(QUICK))
    for interval in (2500, 4000, 2200):
        assert machine.ask("run", 1, interval) == (OK, 0)
        machine.do("wait", 100_000)
        assert machine.report().interval == interval
        assert machine.report().state == 1
    made = machine.steps()
    changes = [made.intervals[0]] + [b for a, b in zip(made.intervals, made.intervals[1:], strict=False) if a != b]
    up, down = QUICK.up, QUICK.down[::-1]
    slowed = [i for i in down if 2500 < i < 4000]
    assert changes == [*(i for i in up if i >= 2500), 2500, *slowed, 4000, *(i for i in up if 2200 <= i < 4000), 2200]
    machine.ask("run", 1, -3000)
    machine.do("wait", 200_000)
    assert machine.report().interval == 3000
    machine.ask("run", 1, 0)
    machine.rest()
    assert [steps > 0 for steps, _ in machine.steps().moves] == [True, False]


def test_run_is_not_faster_than_the_ramp(host: Host) -> None:
    machine = Machine(host, image_of(QUICK))
    assert machine.ask("run", 1, QUICK.slew - 1) == (OUT_OF_RANGE, 0)
    assert machine.ask("run", 1, -(QUICK.slew - 1)) == (OUT_OF_RANGE, 0)
    assert machine.ask("run", 1, 2**28) == (OUT_OF_RANGE, 0)
    assert machine.ask("run", 1, 2**28 - 1) == (OK, 0)


@given(wait=st.integers(0, 200_000))
def test_halt_knows_every_step(host: Host, wait: int) -> None:
    machine = Machine(host, image_of(QUICK))
    machine.move(-300)
    machine.do("wait", wait)
    machine.do("halt", 1)
    report = machine.report()
    machine.do("wait", 50_000)
    assert report.position == machine.steps().travel
    assert (report.state, report.target, report.interval) == (0, report.position, 0)
    machine.move(7)
    machine.rest()
    assert machine.steps().travel == 7 - report.position


@given(wait=st.integers(0, 300_000))
def test_a_report_counts_the_steps_made(host: Host, wait: int) -> None:
    machine = Machine(host, image_of(SHARP))
    machine.move(500)
    machine.do("wait", wait)
    report = machine.report()
    assert report.position == report.steps_made == machine.steps().travel
    assert report.target == 500


def there_and_on(machine: Machine, wait: int, direction: int) -> Steps:
    """Move 3 steps, and 3 more after so long, while the silence after the first ones passes; return all of them."""
    machine.do("position", 1, 0)
    machine.move(3)
    machine.do("wait", wait)
    machine.move(3 + 3 * direction)
    machine.rest()
    return machine.steps()


@pytest.mark.parametrize("direction", [1, -1])
def test_a_move_right_after_another_begins_as_planned(host: Host, direction: int) -> None:
    """Whenever it is asked for, and though what is queued takes its time, nothing waits but the motor at rest."""
    machine = Machine(host, image_of(QUICK))
    machine.do("put", 600)
    planned, before = QUICK.move(3)[:-1], machine.report().starved
    for wait in range(24_800, 26_400, 50):
        intervals = there_and_on(machine, wait, direction).intervals
        assert intervals[:2] == planned == intervals[3:]
        assert machine.report().starved == before


@pytest.mark.parametrize("ticks", [9000, 12_000, 20_000])
def test_steps_that_are_late_do_not_make_the_next_ones_early(host: Host, ticks: int) -> None:
    """Where the main loop takes longer for a segment than that lasts, also while the end of the move is queued."""
    machine = Machine(host, image_of(QUICK))
    machine.do("put", ticks)
    before, planned = machine.report().starved, QUICK.move(40)
    machine.move(40)
    machine.rest()
    made = machine.steps()
    assert made.travel == 40
    assert machine.report().starved > before
    for interval, bounds in zip(made.intervals, itertools.pairwise(planned), strict=True):
        assert interval >= min(bounds)


def test_positions_up_to_the_limits(host: Host) -> None:
    machine = Machine(host, image_of(QUICK))
    machine.do("position", 1, 2**31 - 11)
    machine.move(2**31 - 1)
    machine.rest()
    assert machine.report().position == 2**31 - 1
    assert machine.steps().travel == 10


@pytest.mark.parametrize("direction", [1, -1])
def test_a_run_goes_on_past_the_last_position(host: Host, direction: int) -> None:
    """Positions count modulo 2³²; a stop and a move count from there."""
    machine = Machine(host, image_of(QUICK))
    last = 2**31 - 1 if direction > 0 else -(2**31)
    for before in (0, 5, 60):
        machine.do("position", 1, last - direction * before)
        machine.all_steps()
        machine.ask("run", 1, direction * 2500)
        machine.do("wait", 300_000)
        assert machine.report().state == 1
        machine.do("stop", 1)
        target = machine.report().target
        machine.rest()
        made = machine.steps().travel
        assert abs(made) > 80
        assert machine.report().position == target == last - direction * before + made - direction * 2**32
        assert machine.move(target - direction * 7) == (OK, 0)
        machine.rest()
        assert machine.steps().travel == -direction * 7


@pytest.mark.parametrize("before", range(0, 130, 7))
def test_a_stop_at_the_last_position_ends_where_it_says(host: Host, before: int) -> None:
    machine = Machine(host, image_of(QUICK))
    machine.do("position", 1, 2**31 - 1 - before)
    machine.ask("run", 1, 2000)
    machine.do("wait", 130_000)
    machine.do("stop", 1)
    target = machine.report().target
    machine.rest()
    assert machine.report().position == target
    assert (machine.steps().travel + 2**31 - 1 - before - target) % 2**32 == 0


def test_zero_runs_back_to_zero(host: Host) -> None:
    machine = Machine(host, image_of(QUICK))
    assert machine.ask("zero", 1, 945) == (OK, 0)
    machine.rest()
    assert machine.steps().travel == -945
    assert machine.report().position == 0


def test_without_a_ramp(host: Host) -> None:
    machine = Machine(host, b"")
    assert machine.move(5) == (NO_RAMP, 0)
    assert machine.ask("run", 1, 5000) == (NO_RAMP, 0)
    assert machine.ask("line", 1, 0, 5) == (NO_RAMP, 0)


@pytest.mark.parametrize(("fast", "slew", "status"), [(True, 106, OK), (True, 105, None), (False, 14, OK)])
def test_the_fastest_slew_of_one_axis(host: Host, fast: bool, slew: int, status: int | None) -> None:  # a table
    """150,000 steps/s are 106.7 cycles; a shorter interval is refused by the check of the image."""
    image = image_of(StoredRamp((), slew, ()), fast=fast)
    checked = host.ask("check", image.hex())
    assert checked == ("good 1 1" if status is not None else f"bad {0 << 8 | 255}")
    if status is not None:
        assert Machine(host, image, round_ticks=1000).move(10) == (status, 0)


@pytest.mark.parametrize(("k", "steps"), [(1, 60), (7, 300), (64, 2000)])
def test_trace(host: Host, k: int, steps: int) -> None:
    """The timer's value at the first step and every k-th after it."""
    machine = Machine(host, image_of(QUICK))
    machine.do("trace", 0, k)
    machine.move(steps)
    machine.rest()
    times = machine.steps().times
    assert machine.traced() == [(i + 1, times[i] % 2**16) for i in range(0, steps, k)]


def test_the_motor_is_enabled_in_time_and_let_go(program: Path) -> None:
    """Enabled 3 ms before the first step at least, and for 10 ms after the last interval."""
    settings = bytes([0, 0, 0, 0, 0, 0]) + (30).to_bytes(2, "little") + (3).to_bytes(2, "little") + b"\x0a\x00"
    with Host(program) as host:
        machine = Machine(host, image_of(QUICK), settings)
        machine.move(10)
        ended = machine.rest()
        machine.do("wait", 100_000)
        *before, (on, is_on), (off, is_off) = machine.enabled()
        assert not any(was_on for _, was_on in before)
        assert (is_on, is_off) == (1, 0)
        assert machine.steps().times[0] - on >= 3 * 2000
        assert 9 * 2000 <= off - ended <= 12 * 2000


def enable_times(lead_ms: int, hold_ms: int) -> bytes:
    """Return settings with these."""
    return bytes(6) + b"".join(value.to_bytes(2, "little") for value in (30, lead_ms, hold_ms))


@pytest.mark.parametrize("pause_ms", [1500, 65_550, 66_000, 131_100])
def test_motors_that_have_held_for_long_begin_at_once(program: Path, pause_ms: int) -> None:
    """Also when a count of milliseconds in 16 bits comes round."""
    with Host(program) as host:
        machine = Machine(host, image_of(QUICK), enable_times(1000, 0xFFFF), round_ticks=2000)
        machine.move(10)
        machine.rest()
        on = machine.enabled()[-1][0]
        assert machine.steps().times[0] - on >= 1000 * 2000
        while (left := on + pause_ms * 2000 - machine.rest()) > 0:
            machine.do("wait", left)
        asked = machine.rest()
        machine.move(20)
        machine.rest()
        assert machine.steps().times[0] - asked <= 10 * 2000


def test_motors_that_are_not_held_are_let_go_at_rest_and_not_before(program: Path) -> None:
    with Host(program) as host:
        machine = Machine(host, image_of(QUICK), enable_times(0, 0))
        machine.move(10)
        ended = machine.rest()
        machine.do("wait", 10_000)
        *_, (on, is_on), (off, is_off) = machine.enabled()
        assert (is_on, is_off) == (1, 0)
        assert on < machine.steps().times[0]
        assert off >= ended - 100


def test_motors_are_let_go_after_the_longest_hold(program: Path) -> None:
    """Also when the main loop takes 4 ms for a round, and so misses the last of 65,536 ms."""
    with Host(program) as host:
        machine = Machine(host, image_of(QUICK), enable_times(1, 65_534), round_ticks=8_000)
        machine.move(10)
        ended = machine.rest()
        machine.do("wait", 70_000 * 2000)
        *_, (on, is_on), (off, is_off) = machine.enabled()
        assert (is_on, is_off) == (1, 0)
        assert 65_520 * 2000 <= off - ended <= 65_550 * 2000
        assert on < ended


def test_too_fast_is_a_share_of_the_processor(host: Host) -> None:
    """Wide pulses take their time, and as much again for all else: 200 us of an interval of 100 us."""
    settings = bytes([0, 0, 0, 0, 0, 100]) + (30).to_bytes(2, "little") + bytes(4)
    machine = Machine(host, image_of(StoredRamp((), 200, ())), settings)
    status, percent = machine.move(5)
    assert status == TOO_FAST
    assert percent == (106 + 100 * 32) * 100 // 1600


@pytest.mark.parametrize("order", ["stop 1", "run 1 0"])
def test_what_has_not_set_out_when_it_is_stopped_makes_no_step(host: Host, order: str) -> None:
    """The move is queued, but waits until the motors, which are enabled for it, hold."""
    lead_ms = 100
    settings = bytes([0, 0, 0, 0, 0, 0, *(30).to_bytes(2, "little"), *lead_ms.to_bytes(2, "little"), 0, 0])
    machine = Machine(host, image_of(QUICK), settings)
    machine.do("wait", SLOW_HZ)  # until the motors are let go of
    machine.move(500)
    machine.do("wait", SLOW_HZ * lead_ms // 2000)
    host.ask(*order.split())
    assert (machine.report().position, machine.report().target) == (0, 0)
    machine.do("wait", SLOW_HZ * lead_ms // 500)
    assert machine.report().state == 0
    assert machine.steps().times == []
    machine.move(3)
    machine.rest()
    assert machine.steps().intervals == QUICK.move(3)[:-1]


def test_a_stop_while_the_direction_settles_lets_no_step_be_made(host: Host) -> None:
    """The engine has started, but pulse 1 comes only then; also where the motor turns round."""
    settle_us = 15_000
    settings = bytes([0, 0, 0, 0, 0, 0, *settle_us.to_bytes(2, "little"), 0, 0, 0xFF, 0xFF])
    machine = Machine(host, image_of(QUICK), settings)
    for target in (300, 0):
        position = machine.report().position
        machine.move(target)
        machine.do("wait", SLOW_HZ * settle_us // 2_000_000)
        machine.do("stop", 1)
        assert (machine.report().position, machine.report().target) == (position, position)
        machine.rest()
        assert machine.steps().times == []
        machine.move(target)
        machine.rest()
        machine.steps()
        assert machine.report().position == target


@pytest.mark.parametrize("wait", range(0, 80_000, 1000))
def test_a_stop_where_the_motor_turns_round_lets_it_rest(host: Host, wait: int) -> None:
    """Whether it comes before the rest, in it, or after it: no motor that has come to rest sets out again."""
    settings = bytes([0, 0, 0, 0, 0, 0, *(15_000).to_bytes(2, "little"), 0, 0, 0xFF, 0xFF])
    machine = Machine(host, image_of(QUICK), settings)
    machine.move(3)
    machine.do("wait", 33_000)
    machine.move(-300)
    machine.do("wait", wait)
    machine.do("stop", 1)
    way = machine.report().position
    target = machine.report().target
    machine.rest()
    made = machine.steps()
    assert machine.report().position == target == made.travel
    assert target <= way or not any(made.backward)
