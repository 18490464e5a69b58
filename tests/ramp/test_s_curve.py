"""S-curves: against Ruckig, which plans jerk-limited moves, against mpmath, and against closed forms."""

import math
from itertools import product

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from ruckig import InputParameter, Result, Ruckig, Trajectory

from designs import design
from stepramp.design import Design
from stepramp.numerics.slope import ShapeParameters
from stepramp.ramp.plan import plan_of
from stepramp.ramp.slopes import full_slopes_of, peak_of, slopes_of
from stepramp.shapes.s_curve import SCurve

HZ = 16e6


def s_curve(base: float, slew: float, acceleration: float, jerk: float) -> SCurve:
    return SCurve(HZ, base, slew, acceleration, ShapeParameters(jerk=jerk))


def move(steps: int, base: float, slew: float, up: float, down: float, jerk: float) -> Design:
    """Return a design of an S-curve that is played as its true instants."""
    return design(
        schema="stepramp/2", method={"name": "ideal"}, move={"steps": steps}, timer__frequency_hz=HZ,
        ramp={
            "base_speed_steps_per_s": base, "slew_speed_steps_per_s": slew, "acceleration_steps_per_s2": up,
            "deceleration_steps_per_s2": down, "shape": {"name": "s_curve", "jerk_steps_per_s3": jerk},
        },
    )  # fmt: skip


def planned_by_ruckig(asked: Design) -> Trajectory:
    """Return the same move as Ruckig plans it."""
    ramp, wanted = asked.ramp, InputParameter(1)
    wanted.current_position, wanted.target_position = [0.0], [float(asked.move.steps)]
    wanted.current_velocity = wanted.target_velocity = [ramp.base_speed_steps_per_s]
    wanted.current_acceleration = wanted.target_acceleration = [0.0]
    wanted.max_velocity, wanted.max_acceleration = [ramp.slew_speed_steps_per_s], [ramp.acceleration_steps_per_s2]
    wanted.min_acceleration = [-ramp.slowdown_steps_per_s2]
    wanted.max_jerk = [ramp.shape.jerk_steps_per_s3]
    planned = Trajectory(1)
    assert Ruckig(1).calculate(wanted, planned) == Result.Working
    return planned


GRID = [
    (steps, base, slew, up, up * ratio, jerk)
    for steps, base, slew, up, ratio, jerk in product(
        (1, 7, 60, 1000, 30_000), (0.0, 40.0), (150.0, 1000.0, 8000.0), (500.0, 20_000.0), (1.0, 0.4),
        (1000.0, 50_000.0, 4e6),
    )
]  # fmt: skip


@pytest.mark.parametrize("steps", [1, 7, 60, 1000, 30_000])
def test_ruckig_plans_the_same_moves(steps: int) -> None:
    for values in (each for each in GRID if each[0] == steps):
        asked = move(*values)
        planned, (up, down) = planned_by_ruckig(asked), slopes_of(asked)
        level = steps - up.length - down.length
        assert isinstance(up, SCurve)
        assert isinstance(down, SCurve)
        assert level >= -1e-9, values
        duration = up.duration_s + down.duration_s + max(level, 0) / up.slew_speed
        assert duration == pytest.approx(planned.duration, rel=1e-9), values
        for instants, places in (
            (np.cumsum(up.durations(np.float64)) / HZ, np.arange(1, up.steps + 1)),
            (duration - np.cumsum(down.durations(np.float64)) / HZ, steps - np.arange(1, down.steps + 1)),
        ):
            some = np.unique(np.linspace(0, places.size - 1, 500).astype(int)) if places.size else []
            found = [planned.at_time(instants[step])[0][0] for step in some]
            assert found == pytest.approx(places[some] if len(some) else [], abs=1e-6), values


def test_the_full_symmetric_curve_takes_d_over_v_and_v_over_a_and_a_over_j() -> None:
    slope = s_curve(0, 1000, 5000, 100_000)
    steps = 2000
    duration = 2 * slope.duration_s + (steps - 2 * slope.length) / 1000
    assert duration == pytest.approx(2000 / 1000 + 1000 / 5000 + 5000 / 100_000, rel=1e-15)
    assert slope.length == pytest.approx(1000 / 2 * (1000 / 5000 + 5000 / 100_000))


def state_at(slope: SCurve, place: int) -> tuple[mpmath.mpf, mpmath.mpf]:
    """Return time and speed at a place with 40 digits: the phases integrated, the time halved in."""
    base, slew, most, jerk = map(
        mpmath.mpf, (slope.base_speed, slope.slew_speed, slope.acceleration, slope.parameters.jerk)
    )
    onset = min(most / jerk, mpmath.sqrt((slew - base) / jerk))
    ends = [onset, max((slew - base) / most - most / jerk, mpmath.mpf(0)), onset]

    def walked(time: mpmath.mpf) -> tuple[mpmath.mpf, mpmath.mpf]:
        where, speed, steepness = mpmath.mpf(0), base, mpmath.mpf(0)
        for growth, length in zip((jerk, mpmath.mpf(0), -jerk), ends, strict=True):
            t = min(time, length)
            where += speed * t + steepness * t**2 / 2 + growth * t**3 / 6
            speed += steepness * t + growth * t**2 / 2
            steepness += growth * t
            time -= t
        return where, speed

    low, high = mpmath.mpf(0), sum(ends)
    for _ in range(130):
        middle = (low + high) / 2
        low, high = (middle, high) if walked(middle)[0] < place else (low, middle)
    return low, walked(low)[1]


@given(
    base=st.floats(0, 300), gain=st.floats(1, 5000), acceleration=st.floats(10, 1e6), jerk=st.floats(10, 1e9),
    part=st.floats(0, 1),
)  # fmt: skip
def test_speeds_and_instants_have_the_digits_of_their_numbers(
    base: float, gain: float, acceleration: float, jerk: float, part: float
) -> None:
    slope = s_curve(base, base + gain, acceleration, jerk)
    assume(1 <= slope.length < 1e6)
    step = 1 + int(part * (slope.steps - 1))
    with mpmath.workdps(40):
        (before, _), (time, speed) = state_at(slope, step - 1), state_at(slope, step)
        duration = HZ * (time - before)
    assert slope.speeds(step, 1, np.float64)[0] == pytest.approx(float(speed), rel=1e-12)
    assert slope.speeds(0, slope.steps + 1, np.float64)[step] == pytest.approx(float(speed), rel=1e-12)
    assert slope.durations(np.float64)[step - 1] == pytest.approx(float(duration), rel=1e-9)
    assert slope.speeds(step, 1, np.float32)[0] == pytest.approx(float(speed), rel=1e-4)


@pytest.mark.parametrize(
    ("slew", "acceleration", "jerk"),
    [(2e3, 4e3, 4e4), (2e4, 2e4, 2e5), (1e5, 5e4, 2.5e5), (2e5, 1e5, 5e5)],
)
def test_no_step_of_a_long_ramp_stands_out_in_float32(slew: float, acceleration: float, jerk: float) -> None:
    """Where a phase ends too: instants near there have few digits."""
    slope = s_curve(0, slew, acceleration, jerk)
    precise = slope.durations(np.float64)
    assert np.abs(slope.durations(np.float32) / precise - 1).max() < 2e-5
    # Those of float64 add up to the whole, but for the part of a step that is left.
    left = HZ * (slope.length - slope.steps) / slew
    assert precise.sum() == pytest.approx(HZ * slope.duration_s - left, rel=1e-9)


def test_a_ramp_of_ten_million_steps_ends_where_it_should() -> None:
    slope = s_curve(0, 100_000, 600, 20)
    assert 9_000_000 < slope.steps <= 10_000_000
    durations, speeds = slope.durations(np.float64), slope.speeds(0, slope.steps + 1, np.float64)
    left = (slope.length - slope.steps) / 100_000
    assert math.fsum(durations) / HZ == pytest.approx(slope.duration_s - left, rel=1e-12)
    assert np.all(np.diff(speeds) >= 0)
    assert speeds[-1] <= 100_000


@pytest.mark.parametrize(("steps", "has_peak"), [(1, True), (100, True), (249, True), (250, False), (251, False)])
def test_a_move_too_short_for_the_slew_speed_has_a_peak_of_its_own(steps: int, has_peak: bool) -> None:
    # The ramp to 1000 steps/s takes 125 steps.
    asked = move(steps, 0, 1000, 5000, 5000, 100_000)
    assert (peak_of(asked) is not None) == has_peak
    up, down = slopes_of(asked)
    assert up.length + down.length == pytest.approx(min(steps, 250), rel=1e-12)
    assert plan_of(asked).intervals.size == steps


def test_a_full_ramp_of_any_move_is_that_to_the_slew_speed() -> None:
    asked = move(100, 0, 1000, 5000, 5000, 100_000)
    any_move = asked.model_copy(update={"move": asked.move.model_copy(update={"plan": "any_move"})})
    assert slopes_of(any_move) == full_slopes_of(asked)
    played = plan_of(any_move).intervals
    assert list(played[:50]) == list(plan_of(move(2000, 0, 1000, 5000, 5000, 100_000)).intervals[:50])
