"""The steps that FluidNC really makes, against the second planner that grbl's are held against, with its own timer."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from controllers.grbl.planner import Trapezoid
from designs import design
from stepramp.controllers.fluidnc.own_ramp import own_ramp
from stepramp.controllers.fluidnc.ramp import TIMER
from stepramp.controllers.grbl.motion import intervals_s
from stepramp.controllers.own_ramp import Beside
from stepramp.errors import Rejected

PER_MM = 250.0


def waits_s(steps: int, speed: float, acceleration: float) -> np.ndarray:
    return intervals_s(steps, PER_MM, speed / PER_MM * 60, acceleration / PER_MM, TIMER)


def timer_ticks(ticks: int) -> int:
    """Return what FluidNC makes of ticks of 20 MHz: halved up to three times while there are 2500 or more, 16 bits."""
    level = 0
    while level < 3 and ticks >= 2500:
        ticks, level = ticks >> 1, level + 1
    return min(ticks, 65_535) << level


@given(st.integers(50, 5000), st.floats(400, 20_000), st.floats(1000, 200_000))
def test_it_takes_as_long_as_a_trapezoid(steps: int, speed: float, acceleration: float) -> None:
    lasts_s = Trapezoid(steps, speed, acceleration).lasts_s
    waits = waits_s(steps, speed, acceleration)
    assert waits.size == steps
    assert waits.sum() == pytest.approx(lasts_s, rel=0.01, abs=2 * math.sqrt(2.5 / acceleration) + 0.02)


@given(st.floats(100, 50_000))
@example(200.0)
def test_each_wait_is_one_that_its_timer_makes(speed: float) -> None:
    ticks = np.rint(waits_s(2000, speed, 20_000) * 20e6).astype(int)
    # Between two segments a wait is of both.
    for each in np.unique(ticks[1:][ticks[1:] == ticks[:-1]]):
        assert each in {timer_ticks(int(wish)) for wish in range(int(each), int(each) + 8)}


def test_the_plateau_is_the_asked_speed() -> None:
    assert np.median(waits_s(4000, 5000, 20_000)) == 4000 / 20e6


def test_it_goes_no_slower_than_its_timer() -> None:
    # 65,535 ticks, eight times a step.
    assert TIMER.slowest_steps_per_s == 20e6 / (65_535 * 8)
    assert waits_s(20, 20, 20_000).max() == 65_535 * 8 / 20e6


def test_beside_the_design() -> None:
    beside = Beside.of(design(ramp__base_speed_steps_per_s=100), own_ramp, PER_MM)
    text = " ".join(beside.own.losses)
    for words in (
        "Base speed 100 steps/s is not kept: FluidNC starts from 0",
        "one speed for each 10 ms",
        "I2S_STREAM",
    ):
        assert words in text
    assert float(np.median(np.abs(beside.relative_error))) < 0.02
    with pytest.raises(Rejected, match=r"move\.steps"):
        own_ramp(design(move__steps=5_000_000), PER_MM)
