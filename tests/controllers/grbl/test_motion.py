"""The steps that grbl really makes, against a second planner in closed forms, and against its own timer's limits."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.grbl.planner import Trapezoid, instants_s, timer_cycles
from stepramp.controllers.grbl.motion import SLOWEST_STEPS_PER_S, intervals_s, ticks_of
from stepramp.errors import Refused

PER_MM = 250.0


def waits_s(steps: int, speed: float, acceleration: float, per_mm: float = PER_MM) -> np.ndarray:
    """Return the waits of a move given in steps and seconds."""
    return intervals_s(steps, per_mm, speed / per_mm * 60, acceleration / per_mm)


def instants_of(waits: np.ndarray) -> np.ndarray:
    """Return when each step is made, from the first one on."""
    return np.concatenate(([0.0], np.cumsum(waits)[:-1]))


def test_one_step() -> None:
    # From rest to rest over one step: 2 √(1 / a) = 0.02 s. Speeding up ends in the second part, 10 ms that lead half a
    # step at 100 steps/s: 2 · 0.5 / (100 + 100) s late. Ticked in eighths, each a cycle more.
    [wait] = waits_s(1, 1000, 10_000)
    assert wait * 16e6 == 400_000 + 8


@pytest.mark.parametrize(
    ("steps", "speed", "acceleration"),
    [
        (2, 1000, 5127),
        (7, 131, 571),
        (413, 997, 5113),
        (2003, 1013, 5113),
        (2001, 6011, 20_011),
        (30_011, 20_011, 100_003),
        (509, 29_009, 1_000_003),
        (1_000_003, 10_007, 2003),
    ],
)
def test_the_second_planner_agrees(steps: int, speed: float, acceleration: float) -> None:
    ours = instants_of(waits_s(steps, speed, acceleration))
    theirs = np.array(instants_s(Trapezoid(steps, speed, acceleration)))
    # float32 tells the end of the way apart by 2⁻²⁴ of the whole, so a step may be made in the segment beside.
    late_s = np.abs(ours - theirs + theirs[0])
    assert np.median(late_s) < 1e-5 + 2e-5 * steps / speed
    assert late_s.max() < 0.032768


def test_between_two_segments_an_interval_is_of_both() -> None:
    """Step by step: at such speeds each segment of 10 ms has a step or two."""
    ours = instants_of(waits_s(61, 1000, 5000))
    theirs = np.array(instants_s(Trapezoid(61, 1000, 5000)))
    # float32 has slowing down begin a little elsewhere. Intervals of one segment alone are 4 ms off.
    assert np.abs(ours - theirs + theirs[0]).max() < 2.5e-4


@given(
    st.integers(50, 5000), st.floats(400, 20_000), st.floats(1000, 200_000), st.sampled_from([5.0, 80.0, 250.0, 3200.0])
)
def test_it_takes_as_long_as_a_trapezoid(steps: int, speed: float, acceleration: float, per_mm: float) -> None:
    """N / v + v / a, or 2 √(N / a) where v isn't reached; a cycle a tick more, and less the first segment's wait."""
    lasts_s = Trapezoid(steps, speed, acceleration).lasts_s
    waits = waits_s(steps, speed, acceleration, per_mm)
    assert waits.size == steps
    assert waits.sum() == pytest.approx(lasts_s, rel=0.01, abs=2 * math.sqrt(2.5 / acceleration) + 0.02)


def test_speed_is_level_within_each_segment_of_10_ms() -> None:
    waits = waits_s(4000, 5000, 20_000)
    # Where waits begin to be the same, once a segment has several; between two segments one is of both.
    begins = np.flatnonzero((waits[1:-1] != waits[:-2]) & (waits[1:-1] == waits[2:])) + 1
    up = begins[(begins > 20) & (begins < 600)]
    lasted_s = np.diff(instants_of(waits)[up])
    assert len(up) > 15
    assert np.abs(lasted_s - 0.01).max() < 0.002


def test_the_plateau_is_the_asked_speed_and_one_cycle() -> None:
    waits = waits_s(4000, 10_000, 100_000)
    assert np.median(waits) * 16e6 == 1601


def test_it_goes_no_slower_than_its_timer() -> None:
    # 65,536 cycles, eight times a step.
    assert pytest.approx(30.517578125) == SLOWEST_STEPS_PER_S
    waits = waits_s(2000, 10, 5000)
    assert waits.max() == waits.min() == 0.032768
    assert waits_s(3, 0.5, 0.01).max() == 0.032768


def test_speeding_up_that_ends_just_where_a_part_does() -> None:
    # 10 ms and a step: it is no move that goes no further.
    waits = waits_s(2000, 200, 20_000)
    assert waits.sum() == pytest.approx(Trapezoid(2000, 200, 20_000).lasts_s, rel=0.01)


def test_very_slow_accelerations_end() -> None:
    waits = waits_s(2000, 1000, 0.5)
    # 2 √(N / a), but for what is below the slowest speed at both ends: v² / 2a steps that are played at v.
    slow = int(SLOWEST_STEPS_PER_S**2 / 2 / 0.5)
    assert waits.size == 2000
    assert waits.sum() < 2 * math.sqrt(2000 / 0.5)
    assert (waits == 0.032768).sum() == pytest.approx(2 * slow, rel=0.05)


def test_what_grbl_never_ends_is_refused() -> None:
    # 10⁶ mm are told apart by 1/16 mm in float32, and 10 ms lead 0.02 mm on.
    with pytest.raises(Refused, match="never end"):
        intervals_s(1_000_000, 1.0, 120, 1000)
    with pytest.raises(Refused, match="longer than 1,000,000 s"):
        waits_s(4_000_000, 0.001, 5000)


@given(st.integers(1, 2**31))
def test_the_timers_ticks(cycles: int) -> None:
    assert ticks_of(cycles) == timer_cycles(cycles)
