"""Measured steps against planned ones, when some are missing, late or too many."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from designs import design
from stepramp.capture.deviation import Alignment, deviation_of
from stepramp.ramp.profile import profile_of

Instants = npt.NDArray[np.float64]
PLANNED: Instants = profile_of(design()).time_s
"""2,000 steps: 100 up, 1,800 at 1,000 steps/s, 100 down."""
STEPS = PLANNED.size
BOTH = pytest.mark.parametrize("alignment", ["first_step", "best_fit"])


@BOTH
def test_what_is_planned_has_no_deviation(alignment: Alignment) -> None:
    found = deviation_of(PLANNED, PLANNED, alignment)
    assert found.planned_step.tolist() == list(range(STEPS))
    assert (found.figures.largest_us, found.figures.rms_us, found.missing.size, found.extra.size) == (0, 0, 0, 0)


@BOTH
@settings(max_examples=100)
@given(
    st.sets(st.integers(1, STEPS - 2), max_size=4),
    st.sets(st.integers(5, STEPS - 5), max_size=4),
    st.floats(0.1, 0.9),
)
# An extra step late in its wait, and as many steps as are planned: each wait alone could be one that is late.
@example({932, 1457}, {1085, 1555}, 0.77)
@example({833}, {1185, 1640}, 0.76)
def test_missing_and_extra_steps_shift_nothing_that_follows(
    alignment: Alignment, missing: set[int], doubled: set[int], part: float
) -> None:
    """Of steps far enough apart to tell which is which; an extra one is a part of a wait after a planned one."""
    places = sorted(missing | doubled)
    if missing & doubled or any(b - a < 20 for a, b in pairwise(places)):
        return
    after = {place: PLANNED[place] + part * (PLANNED[place + 1] - PLANNED[place]) for place in doubled}
    made = np.sort(np.concatenate([np.delete(PLANNED, sorted(missing)), list(after.values())]))
    found = deviation_of(made, PLANNED, alignment)
    assert found.missing.tolist() == sorted(missing)
    assert made[found.extra].tolist() == sorted(after.values())
    assert found.figures.largest_us < 1e-6


@BOTH
@pytest.mark.parametrize("count", [2, 5, 40, 700])
@pytest.mark.parametrize("place", [150, 600])
def test_many_missing_at_one_place(alignment: Alignment, count: int, place: int) -> None:
    found = deviation_of(np.delete(PLANNED, np.arange(place, place + count)), PLANNED, alignment)
    assert found.missing.tolist() == list(range(place, place + count))
    assert found.figures.largest_us < 1e-6


@BOTH
@pytest.mark.parametrize("count", [2, 5, 40])
def test_many_too_many_at_one_place(alignment: Alignment, count: int) -> None:
    noise = PLANNED[600] + np.linspace(0.1, 0.4, count) * (PLANNED[601] - PLANNED[600])
    made = np.sort(np.concatenate([PLANNED, noise]))
    found = deviation_of(made, PLANNED, alignment)
    assert found.extra.tolist() == list(range(601, 601 + count))
    assert (found.missing.size, found.figures.largest_us < 1e-6) == (0, True)


@pytest.mark.parametrize("waits", [0.4, 1.0, 4.0, 25.0])
@pytest.mark.parametrize("place", [60, 900, 1950])
def test_a_delay_is_a_delay(waits: float, place: int) -> None:
    """All steps are made, those from one on later: none is missing."""
    late_s = waits * (PLANNED[place] - PLANNED[place - 1])
    made = np.concatenate([PLANNED[:place], PLANNED[place:] + late_s])
    found = deviation_of(made, PLANNED, "first_step")
    assert (found.missing.size, found.extra.size) == (0, 0)
    assert found.deviation_us[:place] == pytest.approx(0, abs=1e-6)
    assert found.deviation_us[place:] == pytest.approx(late_s * 1e6)


@BOTH
@pytest.mark.parametrize("ppm", [-8000, -50, 50, 8000])
def test_a_clock_that_is_not_right(alignment: Alignment, ppm: int) -> None:
    """Over the move it comes to 18 steps: still none is taken for another."""
    found = deviation_of(PLANNED * (1 + ppm * 1e-6), PLANNED, alignment)
    assert (found.missing.size, found.extra.size) == (0, 0)
    assert found.figures.clock_ppm == pytest.approx(ppm, rel=0.01)


def test_deviations_that_are_no_clocks_tell_of_none() -> None:
    even = np.arange(STEPS) * PLANNED[-1] / STEPS  # as long as the ramp, and nowhere like it
    later = np.concatenate([PLANNED[:60], PLANNED[60:] + 0.5])
    for made, why in (
        (even, "The steps are not where a slow"),
        (later, "The steps are not where a slow"),
        (PLANNED[:2], "Of fewer than 3 steps"),
    ):
        figures = deviation_of(made, PLANNED, "first_step").figures
        assert figures.clock_ppm is None
        assert figures.no_clock.startswith(why)
    # Three steps of a plan of three, and twice as many and more between them.
    many = np.linspace(0, 1, 9)
    few = deviation_of(many, np.array([0.0, 0.5, 1.0]), "best_fit").figures
    assert (few.clock_ppm, few.no_clock[:17]) == (None, "Most of the steps")


@pytest.mark.parametrize("lost", [1, 7, 60, 400, 1500])
def test_a_capture_that_begins_within_the_move(lost: int) -> None:
    found = deviation_of(PLANNED[lost:] - PLANNED[lost], PLANNED, "best_fit")
    assert found.missing.tolist() == list(range(lost))
    assert found.figures.largest_us < 1e-6


@BOTH
@pytest.mark.parametrize("left", [1, 2, 50, 1999])
def test_a_capture_that_ends_within_the_move(alignment: Alignment, left: int) -> None:
    found = deviation_of(PLANNED[:left], PLANNED, alignment)
    assert found.planned_step.tolist() == list(range(left))
    assert found.missing.tolist() == list(range(left, STEPS))


def test_the_best_fit_has_the_least_squares() -> None:
    late = np.random.default_rng(1).normal(0.00005, 0.00002, STEPS)
    found = deviation_of(PLANNED + late + 12.5, PLANNED, "best_fit")
    assert found.shift_s == pytest.approx(-12.5 - late.mean())
    assert found.figures.mean_us == pytest.approx(0, abs=1e-6)
    assert found.figures.rms_us == pytest.approx(late.std() * 1e6)
    by_first = deviation_of(PLANNED + late, PLANNED, "first_step")
    assert by_first.deviation_us == pytest.approx((late - late[0]) * 1e6)
    assert by_first.figures.largest_us == pytest.approx(np.abs(late - late[0]).max() * 1e6)
    assert by_first.figures.largest_at_step == np.abs(late - late[0]).argmax()


@settings(max_examples=200)
@given(
    st.lists(st.floats(0, 10), min_size=1, max_size=30).map(sorted),
    st.sets(st.integers(0, 1000), min_size=1, max_size=30).map(sorted),
    st.sampled_from(["first_step", "best_fit"]),
)
def test_whatever_was_made_is_matched_in_order(made: list[float], planned: list[int], alignment: Alignment) -> None:
    found = deviation_of(np.array(made), np.array(planned) / 100, alignment)
    matched = found.planned_step[found.planned_step >= 0]
    assert matched.size
    assert (np.diff(matched) > 0).all()
    assert matched.size + found.missing.size == len(planned)
    assert matched.size + found.extra.size == len(made)
