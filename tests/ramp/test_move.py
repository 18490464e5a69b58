import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as stn

from stepramp.numerics.ramp import Ramp
from stepramp.ramp.move import play, split

lists = stn.arrays(np.int64, st.integers(0, 12), elements=st.integers(1, 9))
ramps = st.builds(Ramp, up=lists, slew=st.just(1), down=lists)


def grown_step_by_step(ramp: Ramp, steps: int) -> tuple[int, int]:
    """The rule as docs/serial_protocol.md words it for a controller."""
    n_up = n_down = 0
    while n_up + n_down < steps and (n_up < ramp.up.size or n_down < ramp.down.size):
        if n_down == ramp.down.size or (n_up < ramp.up.size and ramp.up[n_up] >= ramp.down[n_down]):
            n_up += 1
        else:
            n_down += 1
    return n_up, n_down


@given(ramps, st.integers(1, 30))
def test_a_move_is_split_as_the_protocol_says(ramp: Ramp, steps: int) -> None:
    assert split(ramp, steps) == grown_step_by_step(ramp, steps)


@given(ramps, st.integers(1, 30))
def test_a_move_has_as_many_intervals_as_steps(ramp: Ramp, steps: int) -> None:
    assert play(ramp, steps).size == steps


@given(lists, st.integers(1, 40))
def test_a_symmetric_move_is_its_own_reverse(side: np.ndarray, steps: int) -> None:
    side = np.sort(side)[::-1]
    intervals = play(Ramp(up=side, slew=1, down=side), steps)
    np.testing.assert_array_equal(intervals, intervals[::-1])


def test_the_two_sides_of_a_short_move_meet_at_one_speed() -> None:
    # a = 1000, d = 4000 steps/s²: the speeds are equal where a n_up = d n_down.
    up = 1e6 / np.sqrt(2 * 1000 * np.arange(1, 1001))
    down = 1e6 / np.sqrt(2 * 4000 * np.arange(1, 251))
    assert split(Ramp(up=up, slew=1e6 / 1414.2, down=down), 500) == (400, 100)


@pytest.mark.parametrize(
    ("steps", "expected"),
    [(1, [9]), (2, [9, 9]), (3, [9, 5, 9]), (4, [9, 5, 5, 9]), (5, [9, 5, 2, 5, 9]), (6, [9, 5, 2, 2, 5, 9])],
)
def test_moves_grow_from_their_slow_ends(steps: int, expected: list[int]) -> None:
    side = np.array([9, 5])
    assert play(Ramp(up=side, slew=2, down=side), steps).tolist() == expected


def test_a_ramp_without_steps_slews_at_once() -> None:
    none = np.empty(0, np.int64)
    assert play(Ramp(up=none, slew=7, down=none), 3).tolist() == [7, 7, 7]
