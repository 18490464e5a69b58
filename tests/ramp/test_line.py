from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from designs import design
from stepramp.design import Design
from stepramp.errors import Rejected
from stepramp.ramp.line import leader_of, line_profile, steps_together
from stepramp.ramp.move import play
from stepramp.ramp.plan import real_ramp
from stepramp.ramp.profile import Profile, profile_of

GAUGE = [[10, 5000], [30, 1500], [100, 1000], [150, 800], [300, 600]]

lengths = st.integers(1, 400).flatmap(lambda n_l: st.tuples(st.just(n_l), st.integers(1, n_l)))


def axis_design(base: float, gain: float, acceleration: float, deceleration: float | None, steps: int) -> Design:
    """A timer so fast that rounding to ticks hides nothing."""
    return design(
        timer__frequency_hz=1e9,
        timer__counter_bits=64,
        ramp__base_speed_steps_per_s=base,
        ramp__slew_speed_steps_per_s=base + gain,
        ramp__acceleration_steps_per_s2=acceleration,
        ramp__deceleration_steps_per_s2=deceleration,
        move__steps=steps,
    )


computed = st.builds(
    axis_design,
    base=st.just(0.0) | st.floats(0.001, 300),
    gain=st.floats(1, 1500),
    acceleration=st.floats(100, 1e5),
    deceleration=st.none() | st.floats(100, 1e5),
    steps=st.integers(-3000, 3000).filter(bool),
)
delays = st.lists(st.integers(200, 50_000), min_size=1, max_size=5)
tables = st.builds(
    lambda waits, steps: design(
        method__name="table",
        table__rows=[[9 * row, wait] for row, wait in enumerate(sorted(waits, reverse=True), 1)],
        move__steps=steps,
    ),
    delays,
    st.integers(-300, 300).filter(bool),
)


def planned(designs: list[Design]) -> tuple[Profile, int]:
    leader = leader_of(designs)
    return line_profile(designs, leader)[0], leader


def share(designs: list[Design], axis: int) -> float:
    """Steps of an axis for one of the leader."""
    return abs(designs[axis].move.steps) / max(abs(each.move.steps) for each in designs)


@given(lengths)
def test_a_follower_steps_where_the_rule_grows(steps: tuple[int, int]) -> None:
    n_l, n = steps
    made = [(2 * i * n + n_l) // (2 * n_l) for i in range(n_l + 1)]
    assert (made[0], made[-1]) == (0, n)
    assert steps_together(n_l, n).tolist() == [i + 1 for i, (a, b) in enumerate(pairwise(made)) if b > a]


@given(lengths)
def test_a_controller_that_only_adds_makes_the_same_steps(steps: tuple[int, int]) -> None:
    n_l, n = steps
    together, total = [], n_l
    for i in range(1, n_l + 1):
        total += 2 * n
        if total >= 2 * n_l:
            total -= 2 * n_l
            together.append(i)
    assert steps_together(n_l, n).tolist() == together


@given(lengths)
def test_a_follower_is_at_most_half_a_step_from_the_line(steps: tuple[int, int]) -> None:
    n_l, n = steps
    i = np.arange(1, n_l + 1)
    made = np.searchsorted(steps_together(n_l, n), i, side="right")
    assert np.all(2 * np.abs(made * n_l - i * n) <= n_l)


@given(lengths)
def test_steps_of_a_follower_come_less_than_one_of_the_leaders_early_or_late(steps: tuple[int, int]) -> None:
    n_l, n = steps
    together = steps_together(n_l, n)
    for apart in range(1, n):
        gaps = together[apart:] - together[:-apart]
        assert gaps.min() >= apart * n_l // n
        assert gaps.max() <= -(-apart * n_l // n)


def test_the_longest_line_has_no_overflow() -> None:
    together = steps_together(10_000_000, 9_999_999)
    assert (together[0], together[-1], together.size) == (1, 10_000_000, 9_999_999)
    assert np.unique(np.diff(together)).tolist() == [1, 2]


def test_the_first_of_the_axes_with_most_steps_leads() -> None:
    moves = [design(move__steps=steps) for steps in (5, -900, 900, 7)]
    assert leader_of(moves) == 1


def test_a_line_that_no_follower_limits_is_the_leaders_own_move() -> None:
    moves = [design(move__steps=2000), design(move__steps=1000), design(move__steps=-2000)]
    profile, limits = line_profile(moves, 0)
    assert limits == ()
    np.testing.assert_array_equal(profile.intervals_ticks, profile_of(moves[0]).intervals_ticks)


def test_a_follower_that_allows_exactly_its_share_does_not_limit() -> None:
    third = {"ramp__slew_speed_steps_per_s": 0.1, "ramp__acceleration_steps_per_s2": 0.7, "move__steps": 1000}
    whole = {"ramp__slew_speed_steps_per_s": 0.1 * 3000 / 1000, "ramp__acceleration_steps_per_s2": 0.7 * 3000 / 1000}
    assert line_profile([design(**whole, move__steps=3000), design(**third)], 0)[1] == ()


def test_each_quantity_is_the_least_that_an_axis_allows() -> None:
    leader = design(name="X", ramp__base_speed_steps_per_s=100, move__steps=3000)
    slow = design(name="Y", ramp__slew_speed_steps_per_s=200, ramp__base_speed_steps_per_s=50, move__steps=1500,
                  ramp__acceleration_steps_per_s2=1e6, ramp__deceleration_steps_per_s2=1e6)  # fmt: skip
    weak = design(ramp__base_speed_steps_per_s=90, ramp__acceleration_steps_per_s2=1000, move__steps=-1000)
    profile, limits = line_profile([leader, slow, weak], 0)
    same = design(ramp__base_speed_steps_per_s=100, ramp__slew_speed_steps_per_s=400, move__steps=3000,
                  ramp__acceleration_steps_per_s2=3000)  # fmt: skip
    np.testing.assert_array_equal(profile.intervals_ticks, profile_of(same).intervals_ticks)
    assert [(limit.field, limit.axis) for limit in limits] == [
        ("designs.1.ramp.slew_speed_steps_per_s", 1),
        ("designs.2.ramp.acceleration_steps_per_s2", 2),
        # Not given, so the acceleration is what has to be changed.
        ("designs.2.ramp.acceleration_steps_per_s2", 2),
    ]
    assert limits[0].message == (
        "Y (axis 1) allows a slew speed of 200 steps/s: "
        "along the line that of X (axis 0) is 400 steps/s instead of 1,000 steps/s."
    )
    assert "(axis 2) allows a deceleration of 1,000 steps/s²" in limits[2].message
    assert "is 3,000 steps/s² instead of 5,000 steps/s²" in limits[2].message


@given(st.lists(computed, min_size=2, max_size=4))
def test_no_axis_exceeds_its_own_speeds_and_accelerations(designs: list[Design]) -> None:
    profile, _ = planned(designs)
    for axis, each in enumerate(designs):
        speeds = profile.speed_steps_per_s * share(designs, axis)
        # An interval is off by half a tick at most, a speed's square therefore by one part in that many ticks.
        blur = 1.01 / profile.intervals_ticks.min()
        assert speeds.max() <= each.ramp.slew_speed_steps_per_s * (1 + blur)
        for side, most in (
            (speeds, each.ramp.acceleration_steps_per_s2),
            (speeds[::-1], each.ramp.slowdown_steps_per_s2),
        ):
            squares = np.concatenate(([each.ramp.base_speed_steps_per_s**2], side**2))
            gain = np.diff(squares) - blur * (squares[1:] + squares[:-1])
            assert np.all(gain <= 2 * most * share(designs, axis) * (1 + 1e-9))


@given(tables, computed, computed)
def test_a_table_that_follows_is_nowhere_faster_than_alone(table: Design, second: Design, third: Design) -> None:
    leader = max((second, third), key=lambda each: abs(each.move.steps))
    designs = [leader, table.model_copy(update={"move": table.move.model_copy(update={"steps": 1})})]
    steps = abs(leader.move.steps)
    for n in {1, (steps + 1) // 2, steps}:
        designs[1] = table.model_copy(update={"move": table.move.model_copy(update={"steps": -n})})
        profile, _ = line_profile(designs, 0)
        ramp = real_ramp(table)
        speeds = profile.speed_steps_per_s * n / steps
        under_way = -(-np.arange(1, steps + 1) * n // steps) - 1
        for side, from_slow_end in ((ramp.up, speeds), (ramp.down, speeds[::-1])):
            alone = table.timer.frequency_hz / np.concatenate((side, np.full(steps, ramp.slew)))
            assert np.all(from_slow_end <= alone[under_way] * (1 + 1.01 / profile.intervals_ticks.min()))


@given(tables, st.lists(computed | tables, min_size=1, max_size=3))
def test_followers_of_a_table_are_nowhere_faster_than_alone(table: Design, others: list[Design]) -> None:
    designs = [table, *others]
    leader = leader_of(designs)
    assume(designs[leader].method.name == "table")
    profile, limits = line_profile(designs, leader)
    own = profile_of(designs[leader]).intervals_ticks
    assert np.all(profile.intervals_ticks >= own)
    assert limits or np.all(profile.intervals_ticks == own)
    n_l = own.size
    for each in (each for axis, each in enumerate(designs) if axis != leader):
        n = abs(each.move.steps)
        alone_s = play(real_ramp(each), n) / each.timer.frequency_hz
        under_way = -(-np.arange(1, n_l + 1) * n // n_l) - 1
        half_a_tick_s = 0.5 / designs[leader].timer.frequency_hz
        led_s = (profile.intervals_ticks / designs[leader].timer.frequency_hz + half_a_tick_s) * n_l / n
        assert np.all(led_s >= alone_s[under_way] * (1 - 1e-9))


def test_gauges_with_one_table_play_it_as_it_is() -> None:
    gauges = [design(method__name="table", table__rows=GAUGE, move__steps=steps) for steps in (600, -600, 600)]
    profile, limits = line_profile(gauges, 0)
    assert limits == ()
    np.testing.assert_array_equal(profile.intervals_ticks, profile_of(gauges[0]).intervals_ticks)


def test_a_table_is_stretched_for_a_slow_follower() -> None:
    table = design(name="Gauge", method__name="table", table__rows=GAUGE, move__steps=1000)
    slow = design(ramp__slew_speed_steps_per_s=500, ramp__base_speed_steps_per_s=500, move__steps=1000)
    profile, limits = line_profile([table, slow], 0)
    # 600 µs at top speed become 2,000 µs, and all other delays as many times as long.
    assert profile.intervals_ticks.min() == 4000
    assert profile.intervals_ticks[0] == 33_333
    assert [(limit.field, limit.axis) for limit in limits] == [("designs.1.ramp", 1)]
    assert "(axis 1) can't follow the table of Gauge (axis 0)" in limits[0].message
    assert "3.33333 times as long" in limits[0].message


def test_a_table_alone_is_not_stretched() -> None:
    table = design(method__name="table", table__rows=GAUGE, move__steps=1000)
    profile, limits = line_profile([table], 0)
    assert limits == ()
    np.testing.assert_array_equal(profile.intervals_ticks, profile_of(table).intervals_ticks)


def test_a_table_without_a_ramp_allows_to_reach_its_speed_in_a_step_and_to_leave_it_in_two() -> None:
    gauge = design(method__name="table", table__rows=[[1, 4000]], move__steps=500)
    strong = {"ramp__acceleration_steps_per_s2": 1e6, "move__steps": 1000}
    profile, _ = line_profile([design(**strong), gauge], 0)
    same = {"ramp__slew_speed_steps_per_s": 500, "ramp__acceleration_steps_per_s2": 2 * 250**2 / 2}
    alone = profile_of(design(**same, ramp__deceleration_steps_per_s2=2 * 250**2 / 4, move__steps=1000))
    np.testing.assert_array_equal(profile.intervals_ticks, alone.intervals_ticks)


def test_a_table_that_limits_is_named() -> None:
    gauge = design(method__name="table", table__rows=[[1, 4000]], move__steps=500)
    _, limits = line_profile([design(move__steps=1000), gauge], 0)
    assert {(limit.field, limit.axis) for limit in limits} == {("designs.1.table.rows", 1)}
    _, limits = line_profile([design(method__name="table", table__rows=GAUGE, move__steps=1000), gauge], 0)
    assert {(limit.field, limit.axis) for limit in limits} == {("designs.1.table", 1)}


def test_a_ramp_that_a_follower_makes_too_long_is_refused_at_the_follower() -> None:
    weak = design(ramp__acceleration_steps_per_s2=0.01, ramp__slew_speed_steps_per_s=1000, move__steps=1000)
    with pytest.raises(Rejected) as caught:
        line_profile([design(move__steps=4000), weak], 0)
    [rejection] = caught.value.rejections
    assert (rejection.field, rejection.value) == ("designs.1.ramp.acceleration_steps_per_s2", 0.01)
    assert "at least 0.05 steps/s²" in rejection.allowed
    assert "counted for axis 0, which leads the line with 4,000 steps to 1,000 of this axis" in rejection.allowed


def test_a_follower_so_slow_that_no_table_can_follow_is_refused() -> None:
    table = design(name="Gauge", method__name="table", table__rows=GAUGE, move__steps=1000)
    still = design(method__name="table", table__rows=[[1, 2**32 - 1]], move__steps=1000)
    with pytest.raises(Rejected) as caught:
        line_profile([table, still, design(move__steps=1)], 0)
    [rejection] = caught.value.rejections
    assert rejection.field == "designs.1.table"
    assert "one that slows each delay of Gauge (axis 0) to a whole number from 1 to" in rejection.allowed
    assert rejection.value == {"rows": [(1, 2**32 - 1)], "interval_unit": "us"}


def test_a_table_of_no_ticks_is_refused_at_the_leader() -> None:
    quick = design(method__name="table", table__rows=[[9, 1]], timer__frequency_hz=1000, move__steps=9)
    with pytest.raises(Rejected) as caught:
        line_profile([design(move__steps=2), quick], 1)
    assert caught.value.rejections[0].field.startswith("designs.1.")


def test_what_is_wrong_with_the_leader_is_refused_at_the_leader() -> None:
    with pytest.raises(Rejected) as caught:
        line_profile([design(move__steps=10), design(ramp__acceleration_steps_per_s2=0.01, move__steps=11)], 1)
    assert caught.value.rejections[0].field == "designs.1.ramp.acceleration_steps_per_s2"


def test_a_follower_that_has_no_ramp_of_its_own_is_refused_beside_a_table() -> None:
    table = design(method__name="table", table__rows=GAUGE, move__steps=1000)
    with pytest.raises(Rejected) as caught:
        line_profile([table, design(ramp__acceleration_steps_per_s2=0.01, move__steps=5)], 0)
    assert caught.value.rejections[0].field == "designs.1.ramp.acceleration_steps_per_s2"


def with_jerk(design_: Design, jerk: float, down: float | None = None) -> Design:
    shape = {"name": "s_curve", "jerk_steps_per_s3": jerk, "deceleration_jerk_steps_per_s3": down}
    ramp = design_.ramp.model_dump() | {"shape": shape}
    return Design.checked(design_.model_dump(by_alias=True) | {"schema": "stepramp/2", "ramp": ramp})


def test_the_leaders_shape_holds_with_the_least_jerk_that_an_axis_allows() -> None:
    leader = with_jerk(axis_design(0, 1000, 5000, None, 2000), 50_000)
    follower = with_jerk(axis_design(0, 1000, 5000, None, -500), 10_000, down=5_000)
    profile, limits = line_profile([leader, follower], 0)
    # Four steps of the leader for one of the follower: 40,000 up and 20,000 down.
    alone = profile_of(with_jerk(axis_design(0, 1000, 5000, None, 2000), 40_000, down=20_000))
    assert np.array_equal(profile.intervals_ticks, alone.intervals_ticks)
    assert [limit.field for limit in limits] == [
        "designs.1.ramp.shape.jerk_steps_per_s3", "designs.1.ramp.shape.deceleration_jerk_steps_per_s3",
    ]  # fmt: skip
    assert "jerk of 10,000 steps/s³: along the line" in limits[0].message
    # An axis without a limit of jerk allows any; one with such a limit follows a leader of another shape.
    plain = axis_design(0, 1000, 5000, None, 500)
    assert line_profile([leader, plain], 0)[1] == ()
    alone = profile_of(axis_design(0, 1000, 5000, None, 2000))
    led, none = line_profile([axis_design(0, 1000, 5000, None, 2000), follower], 0)
    assert none == ()
    assert np.array_equal(led.intervals_ticks, alone.intervals_ticks)
