"""plan.c and player.c against the document's merge, step by step."""

from collections.abc import Iterator

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware.host import Host
from firmware.protocol import Ramp, expand
from firmware.strategies import falling_ramps, ramps


def planned(host: Host, ramp: Ramp, steps: int) -> list[int]:
    return [int(number) for number in host.ask("plan", ramp.image().hex(), steps).split()]


def merged(ramp: Ramp, steps: int) -> list[int]:
    up, down = expand(ramp.up), expand(ramp.down)
    n_up = n_down = 0
    while n_up + n_down < steps and (n_up < len(up) or n_down < len(down)):
        if n_down == len(down) or (n_up < len(up) and up[n_up] >= down[n_down]):
            n_up += 1
        else:
            n_down += 1
    return [n_up, steps - n_up - n_down, n_down]


class Played:
    """What the driver printed of a move."""

    def __init__(self, host: Host, ramp: Ramp, steps: int, polls: int = 1, *action: object) -> None:
        numbers, report = host.ask("play", ramp.image().hex(), steps, polls, *action).split(" position ")
        self.intervals = [int(number) for number in numbers.split()]
        words = report.split()
        self.position, self.target, self.made = int(words[0]), int(words[2]), int(words[4])


@given(ramp=ramps(), data=st.data())
def test_plan_is_the_merge(host: Host, ramp: Ramp, data: st.DataObject) -> None:
    both = len(expand(ramp.up)) + len(expand(ramp.down))
    for steps in {1, 2, max(both, 1), both + 1, data.draw(st.integers(1, both + 5))}:
        assert planned(host, ramp, steps) == merged(ramp, steps)


@given(ramp=ramps(), steps=st.integers(1, 90))
def test_each_interval_is_the_merges(host: Host, ramp: Ramp, steps: int) -> None:
    played = Played(host, ramp, steps)
    assert played.intervals == ramp.intervals(steps)
    assert played.position == played.target == played.made == steps


@pytest.mark.parametrize("steps", [1, 2, 3, 59_999, 60_000, 60_001, 200_000])
def test_long_segments(host: Host, steps: int) -> None:
    ramp = Ramp([(60_000, 30_000, -1)], 100, [(60_000, 30_000, -2 + 1)])
    assert Played(host, ramp, steps).intervals == ramp.intervals(steps)


def test_a_symmetric_ramp_of_many_segments(host: Host) -> None:
    up = [(20_000 - 150 * i, 3, -40) for i in range(120)]
    ramp = Ramp(up, 500, up)
    for steps in range(1, 730):
        assert planned(host, ramp, steps) == merged(ramp, steps)


@pytest.mark.parametrize("steps", [2**31 - 1, 2**31, 2**32 - 1])
def test_very_long_moves_are_planned(host: Host, steps: int) -> None:
    ramp = Ramp([(1000, 100, -1)], 500, [(1000, 200, -1)])
    assert planned(host, ramp, steps) == [100, steps - 300, 200]


def test_without_up_and_down_everything_is_slew(host: Host) -> None:
    assert Played(host, Ramp([], 123, []), 70_000).intervals == [123] * 70_000


def stopped_moves(ramp: Ramp, steps: int, first: int, last: int) -> Iterator[list[int]]:
    """Yield all that a stop in intervals first to last may lead to, depending on when the main loop comes round.

    The interrupt learns of the stop in interval `heard`, and takes the way down after interval `turned`.
    """
    plan, down = ramp.intervals(steps), expand(ramp.down)
    n_up, _, n_down = merged(ramp, steps)
    yield plan
    for heard in range(first, min(last + 1, steps)):
        held = plan[heard] if heard < n_up else 0
        going_on = plan[: heard + 1] + [max(interval, held) for interval in plan[heard + 1 :]]
        way = next((i for i, interval in enumerate(down) if interval <= held), len(down)) if held else n_down
        yield going_on
        for turned in range(heard + 1, steps - way):
            yield going_on[: turned + 1] + down[:way][::-1]


@given(ramp=falling_ramps(), data=st.data(), polls=st.integers(0, 3))
def test_stop_ends_where_the_ramp_allows(host: Host, ramp: Ramp, data: st.DataObject, polls: int) -> None:
    steps = data.draw(st.integers(1, 130))
    event = data.draw(st.integers(0, steps))
    slow = max(ramp.intervals(steps)) > 32_767  # some events are silent: the stop comes in an earlier interval
    played = Played(host, ramp, steps, polls, "stop", event)
    assert played.position == played.target == played.made == len(played.intervals) <= steps
    assert played.intervals in stopped_moves(ramp, steps, 0 if slow else max(event - 1, 0), event + 1)


def test_stop_while_slewing_plays_down_whole(host: Host) -> None:
    ramp = Ramp([(2000, 10, -100)], 900, [(1800, 6, -140)])
    played = Played(host, ramp, 1000, 5, "stop", 40)
    assert played.intervals[-6:] == expand(ramp.down)[::-1]
    assert played.intervals[10:-6] == [900] * (len(played.intervals) - 16)
    assert 47 <= played.position <= 49


def test_stop_while_accelerating_holds_the_speed(host: Host) -> None:
    ramp = Ramp([(20_000, 100, -100)], 900, [(20_000, 50, -200)])
    played = Played(host, ramp, 1000, 1, "stop", 51)
    assert played.intervals[:51] == expand(ramp.up)[:51]
    held = played.intervals[51]
    down = [interval for interval in expand(ramp.down) if interval > held]
    assert played.intervals[-len(down) :] == down[::-1]
    assert set(played.intervals[51 : -len(down)]) == {held}
    assert len(played.intervals) - len(down) < 60


def test_stop_while_decelerating_changes_nothing(host: Host) -> None:
    ramp = Ramp([(2000, 10, -100)], 900, [(1800, 6, -140)])
    assert Played(host, ramp, 30, 2, "stop", 26).intervals == ramp.intervals(30)


def test_a_slow_main_loop_never_passes_the_target(host: Host) -> None:
    """The main loop never finds the way down: the speed is held, and the move ends where it was to end."""
    up = [(2000, 30, -60)]
    ramp = Ramp(up, 200, up)
    played = Played(host, ramp, 60, 0, "hold", 20)
    held = expand(up)[19]
    assert played.intervals == [max(interval, held if i >= 20 else 0) for i, interval in enumerate(ramp.intervals(60))]


@given(ramp=ramps(), data=st.data())
def test_any_ramp_can_be_stopped(host: Host, ramp: Ramp, data: st.DataObject) -> None:
    steps = data.draw(st.integers(1, 100))
    played = Played(host, ramp, steps, 2, "stop", data.draw(st.integers(0, 120)))
    assert played.position == played.target == played.made == len(played.intervals) <= steps


@given(ramp=ramps(), data=st.data())
def test_halt_keeps_the_position(host: Host, ramp: Ramp, data: st.DataObject) -> None:
    steps, event = data.draw(st.integers(1, 100)), data.draw(st.integers(0, 120))
    played = Played(host, ramp, steps, 1, "halt", event)
    assert played.position == played.target == played.made
    assert played.made <= min(event, steps)
    plan = ramp.intervals(steps)
    assert played.intervals[: max(played.made - 1, 0)] == plan[: max(played.made - 1, 0)]
