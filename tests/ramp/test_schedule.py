from fractions import Fraction
from itertools import accumulate, pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from designs import design
from stepramp.design import Design
from stepramp.errors import Rejected
from stepramp.ramp.profile import profile_of
from stepramp.ramp.schedule import MOST_LISTED, Mode, Pulses, conflicts_of, merged, schedule_of


def axis_design(timer_hz: int, method: str, slew: int, acceleration: int, steps: int) -> Design:
    return design(
        timer__frequency_hz=timer_hz,
        method__name=method,
        ramp__slew_speed_steps_per_s=slew,
        ramp__acceleration_steps_per_s2=acceleration,
        move__steps=steps,
    )


axes = st.builds(
    axis_design,
    timer_hz=st.sampled_from([1_000_000, 2_000_000, 250_000, 1_843_200]),
    method=st.sampled_from(["exact", "first_order", "table"]),
    slew=st.integers(200, 5000),
    acceleration=st.integers(1000, 100_000),
    steps=st.integers(-60, 60).filter(bool),
)
several = st.lists(axes, min_size=1, max_size=4)
modes: st.SearchStrategy[Mode] = st.sampled_from(["independent", "line"])


def instants(each: Design) -> list[Fraction]:
    """The exact instants of a design's own pulses."""
    intervals = profile_of(each).intervals_ticks.tolist()
    return [ticks / Fraction(each.timer.frequency_hz) for ticks in accumulate(intervals[:-1], initial=0)]


def too_close(pulses: list[tuple[Fraction, int]], spacing: Fraction) -> list[tuple[Fraction, int, int, Fraction]]:
    """All conflicts, by looking at every pair."""
    return [
        (earlier, axis, other, later - earlier)
        for number, (earlier, axis) in enumerate(pulses)
        for later, other in pulses[number + 1 :]
        if axis != other and 0 < later - earlier < spacing
    ]


@given(several)
def test_independent_moves_are_merged_as_by_sorting(designs: list[Design]) -> None:
    pulses = merged(schedule_of(designs, "independent").axes)
    expected = sorted(
        (instant, axis, number * (1 if each.move.steps > 0 else -1))
        for axis, each in enumerate(designs)
        for number, instant in enumerate(instants(each), 1)
    )
    assert pulses.time_s.tolist() == [float(instant) for instant, _, _ in expected]
    assert pulses.axis.tolist() == [axis for _, axis, _ in expected]
    assert pulses.position_steps.tolist() == [position for _, _, position in expected]


@given(several, st.integers(0, 3000))
def test_conflicts_are_those_found_by_looking_at_every_pair(designs: list[Design], spacing_us: int) -> None:
    conflicts = conflicts_of(merged(schedule_of(designs, "independent").axes), spacing_us)
    pulses = sorted((instant, axis) for axis, each in enumerate(designs) for instant in instants(each))
    expected = too_close(pulses, Fraction(spacing_us, 1_000_000))
    assert conflicts.count == len(expected)
    assert len(conflicts.first) == min(MOST_LISTED, len(expected))
    for conflict, (earlier, axis, other, gap) in zip(conflicts.first, expected, strict=False):
        assert (conflict.time_s, conflict.axes) == (float(earlier), (axis, other))
        assert conflict.gap_us == pytest.approx(float(gap) * 1e6, rel=1e-6)


@given(several, modes)
def test_every_axis_makes_exactly_its_steps(designs: list[Design], mode: Mode) -> None:
    schedule = schedule_of(designs, mode)
    pulses = merged(schedule.axes)
    order = list(zip(pulses.time_s.tolist(), pulses.axis.tolist(), strict=True))
    assert order == sorted(order)
    for number, (axis, each) in enumerate(zip(schedule.axes, designs, strict=True)):
        positions = pulses.position_steps[pulses.axis == number]
        assert positions.tolist() == axis.position_steps.tolist()
        assert np.all(np.diff(np.append(0, positions)) == axis.direction)
        assert positions[-1] == each.move.steps == axis.direction * axis.steps
        assert np.all(np.diff(axis.time_s) > 0)
        assert axis.time_s[-1] < axis.pace.duration_s <= schedule.duration_s


@given(several)
def test_followers_step_only_with_the_leader_and_stay_on_the_line(designs: list[Design]) -> None:
    schedule = schedule_of(designs, "line")
    assert schedule.leader is not None
    leader = schedule.axes[schedule.leader]
    assert leader.steps == max(axis.steps for axis in schedule.axes)
    np.testing.assert_array_equal(leader.time_s, leader.pace.time_s)
    for axis in schedule.axes:
        assert set(axis.time_s) <= set(leader.time_s)
        made = np.searchsorted(axis.time_s, leader.time_s, side="right")
        assert np.all(np.abs(made - leader.step * axis.steps / leader.steps) <= 0.5 + 1e-9)
        np.testing.assert_allclose(
            axis.speed_steps_per_s, leader.speed_steps_per_s[axis.pace_step - 1] * axis.steps / leader.steps
        )
        assert axis.pace.duration_s == schedule.duration_s


def test_a_small_line_step_by_step() -> None:
    two, three = (design(name=name, move__steps=steps) for name, steps in (("Y", -2), ("X", 5)))
    schedule = schedule_of([two, three], "line")
    pulses = merged(schedule.axes)
    assert schedule.leader == 1
    # Y's steps come where 2 i / 5 passes a half: with i = 2 and i = 4.
    assert schedule.axes[0].pace_step.tolist() == [2, 4]
    assert pulses.axis.tolist() == [1, 0, 1, 1, 0, 1, 1]
    assert pulses.position_steps.tolist() == [1, -1, 2, 3, -2, 4, 5]
    assert conflicts_of(pulses, 1000).count == 0


def test_pulses_of_one_instant_are_no_conflict() -> None:
    pulses = Pulses(np.array([0.3, 0.3, 0.300015]), np.array([0, 1, 2], np.uint8), np.array([1, 1, 1]))
    conflicts = conflicts_of(pulses, 20)
    assert [conflict.axes for conflict in conflicts.first] == [(0, 2), (1, 2)]
    assert conflicts_of(pulses, 15).count == 0
    assert conflicts_of(pulses, 0).count == 0


@given(st.integers(0, 10**13), st.integers(2, 2_000_000))
def test_a_gap_of_the_shortest_spacing_is_enough_and_a_tick_less_is_not(at: int, gap: int) -> None:
    # In doubles, the difference of the instants is now above and now below the spacing.
    instants = np.array([at, at + gap, at + 2 * gap - 1]) / 2e6
    pulses = Pulses(instants, np.array([0, 1, 2], np.uint8), np.array([1, 1, 1]))
    [conflict] = conflicts_of(pulses, gap / 2).first
    assert conflict.axes == (1, 2)


def test_pulses_of_one_axis_are_no_conflict() -> None:
    assert conflicts_of(merged(schedule_of([design()], "independent").axes), 1e6).count == 0


def test_only_the_first_conflicts_are_listed() -> None:
    together = [design(move__steps=500), design(move__steps=500, ramp__base_speed_steps_per_s=1)]
    conflicts = conflicts_of(merged(schedule_of(together, "independent").axes), 20)
    assert conflicts.count > len(conflicts.first) == MOST_LISTED
    assert all(a.time_s <= b.time_s for a, b in pairwise(conflicts.first))


def test_each_independent_axis_has_its_own_timer_and_duration() -> None:
    designs = [design(move__steps=500), design(timer__frequency_hz=16e6, timer__counter_bits=32, move__steps=900)]
    schedule = schedule_of(designs, "independent")
    assert (schedule.leader, schedule.limits, schedule.warnings) == (None, (), ())
    for axis, each in zip(schedule.axes, designs, strict=True):
        np.testing.assert_array_equal(axis.time_s, profile_of(each).time_s)
        assert axis.pace.duration_s == profile_of(each).duration_s
    assert schedule.duration_s == profile_of(designs[1]).duration_s


@pytest.mark.parametrize("mode", ["independent", "line"])
def test_warnings_name_the_design_that_they_are_about(mode: Mode) -> None:
    designs = [design(move__steps=500), design(move__steps=20), design(move__steps=900, timer__counter_bits=8)]
    fields = {warning.field for warning in schedule_of(designs, mode).warnings}
    follower = {"designs.1.move.steps"} if mode == "independent" else set()
    assert fields == {"designs.2.timer.counter_bits"} | follower


def test_steps_that_the_line_brings_too_close_are_warned_of() -> None:
    # 1,000 steps/s along the line; two steps of the leader in three bring one of the follower.
    leader = design(move__steps=3000)
    follower = design(move__steps=2000, timer__shortest_interval_us=1200)
    [warning] = schedule_of([leader, follower], "line").warnings
    assert warning.field == "designs.1.timer.shortest_interval_us"
    assert "come as close as 1,000 µs, less than the 1200 µs" in warning.message
    assert "at most 555.555 steps/s" in warning.message
    slower = design(move__steps=2000, timer__shortest_interval_us=1200, ramp__slew_speed_steps_per_s=555.555)
    assert schedule_of([leader, slower], "line").warnings == ()
    slower = design(move__steps=2000, timer__shortest_interval_us=1200, ramp__slew_speed_steps_per_s=555)
    assert schedule_of([leader, slower], "line").warnings == ()


def test_a_leader_that_is_too_fast_is_warned_of_once() -> None:
    leader = design(move__steps=3000, timer__shortest_interval_us=1200)
    warnings = schedule_of([leader, design(move__steps=2000)], "line").warnings
    assert [warning.field for warning in warnings] == ["designs.0.timer.shortest_interval_us"]


def test_a_follower_of_one_step_is_never_too_close() -> None:
    assert schedule_of([design(), design(move__steps=1, timer__shortest_interval_us=1e6)], "line").warnings == ()


@given(st.integers(10, 400), st.integers(1, 20_000), modes)
def test_thinning_keeps_the_first_and_the_last_step_of_each_axis(most: int, steps: int, mode: Mode) -> None:
    for axis in schedule_of([design(move__steps=20_000), design(move__steps=-steps)], mode).axes:
        thin = axis.thinned(most)
        assert (thin.step[0], thin.step[-1]) == (1, axis.steps)
        assert np.all(np.diff(thin.step) > 0)
        assert min(axis.steps, 2) <= thin.step.size <= max(most, 12)
        np.testing.assert_array_equal(thin.time_s, axis.time_s[thin.step - 1])
        np.testing.assert_array_equal(thin.position_steps, axis.position_steps[thin.step - 1])
        np.testing.assert_array_equal(thin.speed_steps_per_s, axis.speed_steps_per_s[thin.step - 1])


@pytest.mark.parametrize("mode", ["independent", "line"])
@pytest.mark.parametrize("number", [0, 5])
def test_there_are_one_to_four_axes(mode: Mode, number: int) -> None:
    with pytest.raises(Rejected) as caught:
        schedule_of([design()] * number, mode)
    [rejection] = caught.value.rejections
    assert (rejection.field, rejection.value) == ("designs", f"{number} designs")
    assert rejection.allowed == "a list of 1 to 4 designs"


def test_what_is_wrong_with_a_design_is_refused_at_its_place() -> None:
    with pytest.raises(Rejected) as caught:
        schedule_of([design(), design(ramp__acceleration_steps_per_s2=0.01)], "independent")
    [rejection] = caught.value.rejections
    assert (rejection.field, rejection.value) == ("designs.1.ramp.acceleration_steps_per_s2", 0.01)


def shaped(steps: int, shape: dict[str, object] | None = None, **changes: object) -> Design:
    newer = {} if shape is None else {"schema": "stepramp/2", "method__name": "exact", "ramp__shape": shape}
    return design(name=f"of {steps}", move__steps=steps, **newer, **changes)


S_CURVE = {"name": "s_curve", "jerk_steps_per_s3": 50_000.0}
SOFT, HARD = ({"name": "drawn", "points": [[0, part], [900, 0.5]]} for part in (0.4, 1.0))
TABLE = {"method__name": "table", "table__rows": [[10, 5000], [300, 600]]}


@pytest.mark.parametrize(
    ("leader", "follower", "told"),
    [
        (shaped(900), shaped(300, S_CURVE), "S-curve, does not hold: of 900 (axis 0) leads and has the shape Constant"),
        (shaped(900, SOFT), shaped(300, HARD), "Drawn, does not hold: of 900 (axis 0) leads and has the shape Drawn"),
        (shaped(900, **TABLE), shaped(300, HARD), "Drawn, does not hold: of 900 (axis 0) leads and plays its table."),
        (shaped(900, S_CURVE), shaped(300, S_CURVE), ""),
        (shaped(900, SOFT), shaped(300, SOFT), ""),
        (shaped(900, S_CURVE), shaped(300), ""),
    ],
)
def test_a_follower_whose_shape_does_not_hold_along_the_line_is_told(
    leader: Design, follower: Design, told: str
) -> None:
    warnings = [each for each in schedule_of([leader, follower], "line").warnings if each.field.endswith("shape.name")]
    assert len(warnings) == bool(told)
    for warning in warnings:
        assert warning.field == "designs.1.ramp.shape.name"
        assert warning.message.startswith("Along the line the shape of of 300 (axis 1), ")
        assert told in warning.message
