import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as stn

from stepramp.numerics.ramp import Ramp
from stepramp.ramp.timer import carried, rounded


def test_nearest_rounds_halves_up() -> None:
    ramp = rounded(Ramp(up=np.array([2.5, 3.5, 3.49]), slew=1.5, down=np.array([0.5])), "nearest")
    assert (ramp.up.tolist(), ramp.slew, ramp.down.tolist()) == ([3, 4, 3], 2, [1])


def test_floor_rounds_down() -> None:
    ramp = rounded(Ramp(up=np.array([2.5, 3.99]), slew=1.9, down=np.array([7.01])), "floor")
    assert (ramp.up.tolist(), ramp.slew, ramp.down.tolist()) == ([2, 3], 1, [7])


def test_a_remainder_is_carried_into_the_next_interval() -> None:
    assert carried(np.array([2.5, 2.5, 2.5, 2.5])).tolist() == [2, 3, 2, 3]
    # In order of time a deceleration goes from its fast end to its slow end.
    ramp = rounded(Ramp(up=np.array([4.5, 2.5]), slew=2.4, down=np.array([4.5, 2.5])), "carry")
    assert (ramp.up.tolist(), ramp.slew, ramp.down.tolist()) == ([4, 3], 2, [5, 2])


@given(stn.arrays(np.float64, st.integers(1, 300), elements=st.floats(1, 1e6)))
def test_carrying_keeps_the_time_of_every_step_within_a_tick(intervals: np.ndarray) -> None:
    late = np.cumsum(intervals) - np.cumsum(carried(intervals))
    assert np.all((late > -1e-3) & (late < 1 + 1e-3))
