"""The steps that Marlin really makes, against a second planner, against what is known by hand, and as a trapezoid."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.marlin.planner import Planner
from controllers.marlin.trapezoid import Trapezoid
from stepramp.controllers.marlin.course import Course
from stepramp.controllers.marlin.motion import TICKS_PER_S, Block, intervals_s
from stepramp.controllers.marlin.settings import Settings
from stepramp.errors import Refused

PER_MM = 80.0


def ticks(steps: int, speed: float, acceleration: float, per_mm: float = PER_MM) -> np.ndarray:
    """Return the waits of a move given in steps and seconds, in ticks of the step timer."""
    return np.rint(intervals_s(steps, per_mm, speed / per_mm, acceleration / per_mm) * TICKS_PER_S)


def test_the_first_steps_by_hand() -> None:
    # Before the first step 2,000,000 / 120 = 16,666 ticks pass, 8.333 ms: then 120 + 40,000 · 0.008333 = 453.3 steps/s,
    # 4415 ticks; then 120 + 40,000 · (16,666 + 4415) / 2,000,000 = 541.6 steps/s, 3690 ticks; and one more each.
    assert ticks(400, 8000, 40_000)[:2].tolist() == [4416, 3691]


def test_the_plateau_is_the_asked_speed_and_one_tick() -> None:
    assert np.median(ticks(20_000, 8000, 40_000)) == 2_000_000 // 8000 + 1


@pytest.mark.parametrize(
    ("steps", "speed", "acceleration"),
    [
        (1, 1000, 5120),
        (2, 1000, 5120),
        (7, 160, 560),
        (413, 1000, 5120),
        (2003, 1040, 5120),
        (2001, 6000, 20_000),
        (30_011, 20_000, 100_000),
        (509, 29_040, 1_000_000),
        (60_007, 10_000, 2000),
    ],
)
def test_the_second_planner_agrees(steps: int, speed: int, acceleration: int) -> None:
    ours = ticks(steps, speed, acceleration)
    # Rates are whole, and float32 may leave a step/s of the highest one off.
    rates = (speed, speed - 1)
    theirs = min(
        (np.array(Trapezoid(steps, rate, acceleration).waits()) for rate in rates),
        key=lambda waits: abs(waits - ours).sum(),
    )
    # Where a rate lies between two whole ones they differ by a step/s; and by what the speed changes over a step, which
    # 24 bits and whole ticks may add up to over a ramp.
    waits_s = theirs / TICKS_PER_S
    assert (np.abs(ours - theirs) <= 2 + (2 + 1.5 * acceleration * waits_s) * waits_s * theirs).all()


@given(st.integers(6, 5000), st.integers(200, 20_000), st.integers(1000, 200_000), st.sampled_from([5.0, 80.0, 400.0]))
def test_it_takes_as_long_as_a_trapezoid(steps: int, speed: int, acceleration: int, per_mm: float) -> None:
    """From 120 steps/s to 120 steps/s; a tick more each step, and less what comes before the first."""
    waits = ticks(steps, speed, acceleration, per_mm) / TICKS_PER_S
    ends = 120.0
    peak = min(float(speed), math.sqrt(ends**2 + acceleration * steps))
    ramp_s, ramp_steps = (peak - ends) / acceleration, (peak**2 - ends**2) / (2 * acceleration)
    lasts_s = 2 * ramp_s + max(0.0, steps - 2 * ramp_steps) / peak
    assert waits.size == steps
    # Steps at the ends, which may last as long as at 120 steps/s, aren't shared out evenly.
    assert waits.sum() == pytest.approx(lasts_s, abs=0.03 * lasts_s + 3 / ends)


def test_it_never_goes_faster_than_asked_and_rises_and_falls() -> None:
    waits = ticks(4000, 5000, 20_000)
    assert waits.min() >= TICKS_PER_S / 5000
    top = int(np.argmin(waits))
    assert (np.diff(waits[:top]) <= 0).all()
    assert (np.diff(waits[-600:]) >= 0).all()


def test_a_slow_axis_keeps_its_speed_though_moves_begin_at_120() -> None:
    assert set(ticks(50, 40, 1000).tolist()) == {50_001}


def test_a_fine_axis_begins_at_the_least_speed() -> None:
    # 0.05 mm/s at 3200 steps/mm.
    assert Block.of(10_000, 3200.0, 10.0, 100.0).ends_rate == 160


def test_what_marlin_doesnt_plan_is_refused() -> None:
    with pytest.raises(Refused, match="less than 1 step/s"):
        intervals_s(100, 0.5, 10.0, 1.0)
    with pytest.raises(Refused, match="longer than 2,000 s"):
        intervals_s(4_000_000, 80.0, 10.0, 100.0)


def test_where_axes_are_on_their_way_is_what_the_motors_do() -> None:
    """The closed form against the emulator's planner, which goes slice by slice."""
    settings = Settings.of(
        ["M92 X80 Y80 Z400 E93", "M203 X100 Y100 Z5 E25", "M201 X500 Y400 Z100 E50", "M204 P500 R500 T1000"]
    )
    planner = Planner(
        lambda: {
            code: {a: float(b) for a, b in settings.words(code).items()} for code in ("M92", "M203", "M201", "M204")
        }
    )
    target = {"X": 4000, "Y": -2000, "Z": 0, "E": 0}
    planner.add(target, 1e6)
    course = Course.of(0.0, {0: (0, 4000), 1: (0, -2000)}, settings.axes(), settings)
    now_s = 0.0
    while planner.is_busy:
        now_s += 0.001
        planner.go_on(0.001)
        places = course.places(now_s)
        assert places[0] == pytest.approx(planner.counts["X"], abs=25)
        assert places[1] == pytest.approx(planner.counts["Y"], abs=13)
    assert course.ends_s == pytest.approx(now_s, abs=0.02)
