import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from designs import design
from stepramp.ramp.profile import profile_of
from stepramp.ramp.thinning import kept_steps

METHODS = st.sampled_from(["exact", "first_order", "table"])


@given(METHODS, st.integers(1, 30_000), st.integers(10, 3000))
def test_ends_extremes_and_phases_are_kept_in_about_so_many_points(method: str, steps: int, most: int) -> None:
    profile = profile_of(design(method__name=method, move__steps=steps))
    curve = profile.intervals_ticks
    kept = kept_steps(curve, profile.phases, most)
    assert np.all(np.diff(kept) > 0)
    assert (kept[0], kept[-1]) == (0, steps - 1)
    assert kept.size <= max(most, 12)
    assert {curve.min(), curve.max()} <= set(curve[kept])


@pytest.mark.parametrize("method", ["exact", "first_order", "table"])
def test_a_thinned_curve_lies_within_a_percent_of_the_whole(method: str) -> None:
    profile = profile_of(
        design(method__name=method, ramp__acceleration_steps_per_s2=50, ramp__deceleration_steps_per_s2=80,
               move__steps=1_000_000, table__rows=[[50, 4000], [3000, 900], [9000, 500]])
    )  # fmt: skip
    kept = kept_steps(profile.intervals_ticks, profile.phases, 2000)
    drawn = np.interp(np.arange(1_000_000), kept, profile.intervals_ticks[kept])
    error = np.abs(drawn / profile.intervals_ticks - 1)
    assert kept.size <= 2000
    assert np.quantile(error, 0.999) < 0.01


def test_a_level_stretch_keeps_its_two_ends() -> None:
    profile = profile_of(design(move__steps=1_000_000))
    kept = kept_steps(profile.intervals_ticks, profile.phases, 500)
    level = profile.intervals_ticks[kept] == 2000
    assert np.count_nonzero(level) == 2
