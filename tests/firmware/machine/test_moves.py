import itertools

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from firmware.host import Host
from firmware.machine.ramps import QUICK, ramp_of
from firmware.motion import FAST_HZ, OK, SETUP_TICKS, SLOW_HZ, Machine, StoredRamp, image_of

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
