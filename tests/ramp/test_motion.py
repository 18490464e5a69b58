"""Acceleration and jerk of a planned move, against closed forms."""

from typing import Any

import numpy as np
import pytest

from designs import document
from stepramp.design import Design
from stepramp.ramp.drawing import Drawing
from stepramp.ramp.motion import Motion, motion_of

JERK = 40_000.0


def motion(**ramp: Any) -> tuple[Motion, Any]:
    """Return acceleration and jerk of a move of 2,000 steps, up to 2,000 steps/s at 4,000 steps/s²; and its phases."""
    asked = document(
        schema="stepramp/2",
        ramp={"base_speed_steps_per_s": 0, "slew_speed_steps_per_s": 2000, "acceleration_steps_per_s2": 4000, **ramp},
        move={"steps": 2000},
        timer={"frequency_hz": 16_000_000, "counter_bits": 32},
        method={"name": "exact"},
    )
    [(_, drawn)] = Drawing(Design.checked(asked), ("exact",), "exact", 4000, with_motion=True).methods()
    return drawn.motion, drawn.judged.profile.phases  # type: ignore[return-value, union-attr]


def test_a_constant_ramp_has_its_acceleration_and_jerk_only_where_it_begins_and_ends() -> None:
    found, (up, slew, down) = motion()
    assert (up.last_step, down.last_step - down.first_step + 1) == (500, 500), "v² / 2a"
    accelerations, jerks = found.acceleration_steps_per_s2, found.jerk_steps_per_s3
    assert accelerations[: up.last_step] == pytest.approx(4000, rel=1e-9)
    assert accelerations[slew.first_step + 1 : slew.last_step] == pytest.approx(0, abs=1e-6)
    assert accelerations[down.first_step :] == pytest.approx(-4000, rel=1e-9)
    assert jerks[: up.last_step - 1] == pytest.approx(0, abs=0.01)
    assert jerks.min() == pytest.approx(-4000 * 2000, rel=2e-3), "all of a goes within a step at slew speed"
    assert jerks[-1] == pytest.approx(0, abs=0.01), "the last step leaves the base speed behind with d as well"


def test_an_s_curve_begins_as_its_closed_form_and_keeps_its_jerk() -> None:
    found, (up, *_) = motion(shape={"name": "s_curve", "jerk_steps_per_s3": JERK})
    onset_steps = JERK * (4000 / JERK) ** 3 / 6
    count = int(onset_steps)
    # From rest s = j t³ / 6 and v = j t² / 2, so v² / 2 = (j t²)² / 8.
    times = np.cbrt(6 * np.arange(count + 1) / JERK)
    expected = np.diff((JERK * times**2) ** 2 / 8)
    assert found.acceleration_steps_per_s2[:count] == pytest.approx(expected, rel=1e-9)
    assert np.abs(found.acceleration_steps_per_s2).max() == pytest.approx(4000, rel=1e-3)
    jerks = found.jerk_steps_per_s3
    assert np.abs(jerks).max() < 1.18 * JERK, "from rest the first steps are long: (4.5)^(1/3) of 1.363 (2^(4/3) - 2) j"
    assert np.abs(jerks[10:-10]).max() < 1.02 * JERK
    near_the_end = slice(up.last_step - 30, up.last_step - 5)
    assert jerks[near_the_end] == pytest.approx(-JERK, rel=0.01)


def test_a_move_backwards_in_time_has_the_same_jerk_and_the_acceleration_with_the_other_sign() -> None:
    intervals = np.random.default_rng(3).uniform(100, 10_000, 50)
    there, back = motion_of(intervals, 1e6, 50), motion_of(intervals[::-1].copy(), 1e6, 50)
    assert back.jerk_steps_per_s3[::-1] == pytest.approx(there.jerk_steps_per_s3, rel=1e-9)
    assert -back.acceleration_steps_per_s2[1:][::-1] == pytest.approx(there.acceleration_steps_per_s2[1:], rel=1e-9)
