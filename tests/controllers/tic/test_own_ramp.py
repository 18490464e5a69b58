"""The ramp that a Tic plays, beside a second computation in exact decimals and beside the emulator."""

from __future__ import annotations

from decimal import Decimal, localcontext
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from controllers.bench import by
from controllers.tic.bench import Bench
from designs import design
from stepramp.controllers.tic.own_ramp import intervals_s, own_ramp
from stepramp.controllers.tic.ramp import TicRamp

TICKS_HZ = 3_000_000


def instants(way: int, start: Decimal, rate: Decimal) -> Decimal:
    """Return how long it takes to come so far from a starting speed, speeding up evenly: t with v0 t + a t²/2."""
    return ((start * start + 2 * rate * way).sqrt() - start) / rate


def ticks_of_ramp(ramp: TicRamp, steps: int) -> list[int]:
    """Return the guide's rule, 3·10¹⁰ over a speed in its units, of the mean speed over each step that speeds up."""
    with localcontext() as context:
        context.prec = 60
        start, rate = Decimal(ramp.starting_speed) / 10_000, Decimal(ramp.max_acceleration) / 100
        at = [instants(way, start, rate) for way in range(steps + 1)]
        units = [int(10_000 / (later - sooner)) for sooner, later in pairwise(at)]
    return [30_000_000_000 // each for each in units]


def ramp(start: int = 0, fastest: int = 500_000_000, down: int = 500_000, up: int = 500_000) -> TicRamp:
    return TicRamp(start, fastest, down, up)


@given(st.integers(0, 5_000_000), st.integers(100, 2**31 - 1), st.integers(1, 60))
@example(18_524, 100, 30)
def test_it_speeds_up_evenly_in_whole_ticks(start: int, rate: int, steps: int) -> None:
    """As long as neither the highest speed nor the end is near; one tick, and one unit of speed, may go either way."""
    asked = ramp(start, up=rate, down=2**31 - 1)
    expected = ticks_of_ramp(asked, steps)
    played = intervals_s(asked, 200_000)[:steps] * TICKS_HZ
    reached = [ticks > 61 for ticks in expected]
    # A unit more makes a step so much shorter, where the speed is a whole number of them but for the last bits.
    of_a_unit = np.square(np.array(expected, float)) / 30_000_000_000
    off = (np.abs(np.round(played) - expected) - of_a_unit)[np.array(reached)]
    assert off.size == 0 or off.max() <= 1


@given(st.integers(10_000, 500_000_000), st.integers(10_000, 10**7), st.integers(1, 3000))
def test_at_speed_each_step_takes_what_the_guide_says(fastest: int, rate: int, steps: int) -> None:
    played = intervals_s(ramp(fastest, fastest, rate, rate), steps)
    assert played.shape == (steps,)
    assert set(np.round(played * TICKS_HZ).astype(int)) == {30_000_000_000 // fastest}


@given(st.integers(0, 10**6), st.integers(100, 10**7), st.integers(1, 2000))
def test_equal_accelerations_are_the_same_backwards(start: int, rate: int, steps: int) -> None:
    """But for whole numbers of ticks that are just missed on one side."""
    ticks = np.round(intervals_s(ramp(start, down=rate, up=rate), steps) * TICKS_HZ)
    assert np.all(np.abs(ticks - ticks[::-1]) <= 1 + 1e-6 * ticks)


@given(st.integers(100, 10**7))
def test_a_single_step_speeds_up_for_half_its_way(rate: int) -> None:
    """2 √(1/a)."""
    [wait] = intervals_s(ramp(down=rate, up=rate), 1)
    assert wait == pytest.approx(2 * (100 / rate) ** 0.5, rel=1e-3)


def test_a_step_from_rest_takes_as_long_as_one_at_half_its_final_speed() -> None:
    """√(2/a): 0.02 s with 5000 steps/s²."""
    assert intervals_s(ramp(), 3000)[0] == pytest.approx(0.02, abs=1e-6)


def test_the_emulator_takes_as_long(bench: Bench) -> None:
    """Its own law is another one, v² grows by 2 a a step: from the tenth step on they are within 1/(2 k)."""
    bench.controller.connect()
    bench.controller.prepare_push([design(ramp__deceleration_steps_per_s2=2500)], 0, "try")()
    bench.tic.waits.clear()
    bench.controller.move_by(by(1200))
    bench.rest()
    own = own_ramp(design(move__steps=1200, ramp__deceleration_steps_per_s2=2500), 1.0).intervals_s
    made = np.array(bench.tic.waits) / TICKS_HZ
    assert made.shape == own.shape == (1200,)
    from_either_end = np.minimum(np.arange(1, 1201), np.arange(1200, 0, -1))
    assert np.all(np.abs(made / own - 1)[from_either_end > 9] < 0.5 / from_either_end[from_either_end > 9])
    assert made.sum() == pytest.approx(own.sum(), abs=own[0] + own[-1])


def test_what_is_assumed_is_said() -> None:
    *losses, assumed = own_ramp(design(), 1.0).losses
    assert losses == ["The method Exact is not kept: a Tic works its intervals out itself."]
    assert "isn't published" in assumed
